"""An uploaded query whose analysis process is killed is tried again, then 503, never 500."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import httpx2
import psutil
import pytest

from app.demo import DemoClip
from tests.api.conftest import assert_problem
from tests.busy_processes import ENDLESS, LONG, busy_children, children_of, repeated, server_of
from tests.live import Live, serve


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    with serve(tmp_path_factory.mktemp("killed") / "data") as live:
        yield live


@pytest.fixture
def api(service: Live) -> psutil.Process:
    """The process of the API."""
    for child in psutil.Process().children():
        folder = child.environ().get("KINEDEX_DATA_DIR")
        if folder == str(service.data_dir) and "app.api.server" in child.cmdline():
            return child
    raise LookupError


@contextmanager
def _killing(find: Callable[[], list[psutil.Process]], times: int) -> Iterator[list[int]]:
    """Kill up to `times` processes that `find` returns. Yields the ids of the killed processes."""
    stop, killed = threading.Event(), list[int]()

    def hunt() -> None:
        while not stop.wait(0.01) and len(killed) < times:
            for process in find():
                if process.pid not in killed and len(killed) < times:
                    process.kill()
                    killed.append(process.pid)

    thread = threading.Thread(target=hunt)
    thread.start()
    try:
        yield killed
    finally:
        stop.set()
        thread.join()


def _ask(service: Live, url: str, content: bytes) -> httpx2.Response:
    with service.client() as client:
        return client.post(url, files={"file": ("long.bvh", content)})


def test_a_search_succeeds_after_one_kill(
    service: Live, api: psutil.Process, take: DemoClip
) -> None:
    with _killing(lambda: busy_children(api), 1) as killed:
        answer = _ask(service, "/v1/search/motion", repeated(take, LONG))
    assert len(killed) == 1
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize("url", ["/v1/search/motion", "/v1/recognize"])
def test_repeated_kills_are_a_503_with_retry_after(
    service: Live, api: psutil.Process, take: DemoClip, url: str
) -> None:
    with _killing(lambda: busy_children(api), 1000) as killed:
        answer = _ask(service, url, repeated(take, ENDLESS))
    assert len(killed) >= 2
    assert_problem(answer, 503, "analysis_interrupted")
    assert answer.headers["retry-after"].isdigit()
    assert _ask(service, "/v1/search/motion", take.content).status_code == 200


def test_a_killed_fork_server_ends_no_request(
    service: Live, api: psutil.Process, take: DemoClip
) -> None:
    assert _ask(service, "/v1/search/motion", take.content).status_code == 200
    for _ in range(2):
        server = server_of(api)
        assert server is not None
        for child in children_of(api):
            child.kill()
        server.kill()
        assert _ask(service, "/v1/search/motion", take.content).status_code == 200
    assert api.is_running()
