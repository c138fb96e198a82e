"""Two processes of the API behind one port: a client cannot tell which one answers."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx2
import psutil
import pytest
from prometheus_client.parser import text_string_to_metric_families

from app.config import Settings
from app.demo import demo_clips
from app.errors import ConfigurationError
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from app.worker.api_processes import ApiProcesses
from tests.live import ACTORS, NET_S, TASKS, Live, wait_until
from tests.live import _free_port as free_port

PROGRAM = "from app.cli import main; main()"
PROCESSES = 2
CONNECTIONS = 16
"""New connections at once: no process takes all of them."""


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """`kinedex serve --processes 2` with a worker, and a few clips."""
    data_dir = tmp_path_factory.mktemp("processes") / "data"
    port, log = free_port(), data_dir.parent / "serve.log"
    command = [sys.executable, "-c", PROGRAM, "--data-dir", str(data_dir), "serve"]
    command += ["--port", str(port), "--processes", str(PROCESSES)]
    settings = {"REQUEST_TIMEOUT_S": NET_S, "RATE_LIMIT_PER_MINUTE": 1}
    environ = os.environ | {f"KINEDEX_{name}": str(value) for name, value in settings.items()}
    with log.open("wb") as lines:
        served = subprocess.Popen(command, env=environ, stdout=lines, stderr=lines)
    service = Live(f"http://127.0.0.1:{port}", data_dir, log)
    try:
        wait_until(lambda: served.poll() is not None or _all_ready(service), NET_S)
        assert served.poll() is None, log.read_text()
        for clip in demo_clips(ACTORS, TASKS[:1], takes=2):
            service.wait_for_job(service.upload(clip).json()["job"]["id"])
        yield service
    finally:
        served.terminate()
        served.wait(NET_S)
    assert not _processes(service)


def _processes(service: Live) -> list[psutil.Process]:
    """The processes of the API, by the socket that they listen on."""
    found = []
    for process in psutil.process_iter(["cmdline", "environ"]):
        environ, command = process.info["environ"] or {}, process.info["cmdline"] or []
        if "app.api.server" in command and environ.get("KINEDEX_DATA_DIR") == str(service.data_dir):
            found.append(process)
    return found


def _all_ready(service: Live) -> bool:
    if len(_processes(service)) < PROCESSES:
        return False
    try:
        answers = _everywhere(service, lambda client: client.get("/readyz").status_code)
    except httpx2.TransportError:
        return False
    return set(answers) == {200}


def _everywhere(service: Live, ask: Callable[[httpx2.Client], object]) -> list[object]:
    """The answers to the same call on many new connections at once."""

    def one(_: int) -> object:
        with service.client() as client:
            return ask(client)

    with ThreadPoolExecutor(CONNECTIONS) as pool:
        return list(pool.map(one, range(CONNECTIONS)))


def _families(client: httpx2.Client) -> dict[str, dict[str, float]]:
    """The values of metrics by name, and by the process or the path that they describe."""
    found: dict[str, dict[str, float]] = {}
    for family in text_string_to_metric_families(client.get("/metrics").text):
        for sample in family.samples:
            labels = sample.labels
            key = labels.get("pid") or labels.get("handler", "")
            values = found.setdefault(sample.name, {})
            values[key] = values.get(key, 0.0) + sample.value
    return found


def test_both_processes_answer(live: Live) -> None:
    before = {p.pid: sum(p.cpu_times()[:2]) for p in _processes(live)}
    assert len(before) == PROCESSES
    for _ in range(4):
        _everywhere(live, lambda client: client.get("/v1/clips").status_code)
    after = {p.pid: sum(p.cpu_times()[:2]) for p in _processes(live)}
    assert all(after[pid] > before[pid] for pid in before)


def test_a_new_clip_is_found_by_all_at_once(live: Live) -> None:
    clip = next(demo_clips(["chika"], ["wave"], takes=1))
    created = live.upload(clip).json()
    live.wait_for_job(created["job"]["id"])
    asked = {"clip_id": created["clip"]["id"], "include_self": True, "limit": 1}

    def first(client: httpx2.Client) -> object:
        return client.post("/v1/search/motion", json=asked).json()["items"][0]["clip"]["id"]

    assert set(_everywhere(live, first)) == {created["clip"]["id"]}


def test_a_changed_clip_is_shown_by_all_at_once(live: Live) -> None:
    with live.client() as client:
        clip = client.get("/v1/clips", params={"limit": 1}).json()["items"][0]["id"]
    asked = {"clip_id": clip, "include_self": True, "limit": 1}

    def name(client: httpx2.Client) -> object:
        return client.post("/v1/search/motion", json=asked).json()["items"][0]["clip"]["name"]

    for changed in ("one name", "another name"):
        with live.client() as client:
            client.patch(f"/v1/clips/{clip}", json={"name": changed})
        assert set(_everywhere(live, name)) == {changed}


def test_events_of_a_fit_and_its_models_reach_all(live: Live) -> None:
    with live.client() as client:
        job = client.post("/v1/models/fit").json()["job"]["id"]

    def last_event(client: httpx2.Client) -> object:
        lines = client.get(f"/v1/jobs/{job}/events").text.splitlines()
        data = [line.removeprefix("data: ") for line in lines if line.startswith("data: ")]
        return json.loads(data[-1])["state"]

    assert set(_everywhere(live, last_event)) == {"succeeded"}

    def models(client: httpx2.Client) -> object:
        return tuple(sorted(model["id"] for model in client.get("/v1/models").json()["items"]))

    def recognized(client: httpx2.Client) -> object:
        clip = client.get("/v1/clips", params={"limit": 1}).json()["items"][0]["id"]
        return client.post("/v1/recognize", json={"clip_id": clip}).status_code

    (found,) = set(_everywhere(live, models))
    assert found
    assert len(set(_everywhere(live, recognized))) == 1


def test_cursors_and_keys_of_calls_hold_everywhere(live: Live) -> None:
    with live.client() as client:
        clip = client.get("/v1/clips", params={"limit": 1}).json()["items"][0]["id"]
        page = client.post("/v1/search/motion", json={"clip_id": clip, "limit": 2}).json()
    more = {"clip_id": clip, "limit": 2, "cursor": page["next"]}

    def next_page(client: httpx2.Client) -> object:
        found = client.post("/v1/search/motion", json=more).json()
        return tuple(hit["clip"]["id"] for hit in found["items"])

    assert len(set(_everywhere(live, next_page))) == 1

    def hook(client: httpx2.Client) -> object:
        body = {"url": "https://example.org/hook"}
        for _ in range(100):
            answer = client.post("/v1/webhooks", json=body, headers={"Idempotency-Key": "one"})
            if answer.status_code != 409:  # another process is still doing it
                return answer.json()["id"]
        return None

    assert len(set(_everywhere(live, hook))) == 1


def test_the_metrics_are_those_of_all(live: Live) -> None:
    def listed(client: httpx2.Client) -> object:
        return client.get("/v1/jobs").status_code

    with live.client() as client:
        before = _families(client)["http_requests_total"].get("/v1/jobs", 0.0)
        _everywhere(live, listed)
        wait_until(
            lambda: (
                _families(client)["http_requests_total"].get("/v1/jobs", 0.0)
                == before + CONNECTIONS
            ),
            NET_S,
        )
        found = _families(client)
    pids = {str(process.pid) for process in _processes(live)}
    assert found["process_resident_memory_bytes"].keys() == pids
    assert min(found["process_cpu_seconds_total"].values()) > 0.0
    assert found["kinedex_database_up"] == {"": 1.0}


def test_one_that_is_killed_under_load_is_replaced_and_nothing_else_fails(live: Live) -> None:
    with live.client() as client:
        clip = client.get("/v1/clips", params={"limit": 1}).json()["items"][0]["id"]
    statuses: Counter[object] = Counter()
    stop = threading.Event()

    def ask() -> None:
        while not stop.is_set():
            try:
                with live.client() as client:
                    answer = client.post("/v1/search/motion", json={"clip_id": clip})
                    statuses[answer.status_code] += 1
            except httpx2.TransportError:
                statuses["broken"] += 1

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    wait_until(lambda: statuses[200] > 10, NET_S)
    victim, other = _processes(live)
    victim.send_signal(signal.SIGKILL)
    answered = statuses[200]
    wait_until(lambda: statuses[200] > answered + 10, NET_S)
    wait_until(lambda: len(_processes(live)) == PROCESSES, NET_S)
    stop.set()
    for thread in threads:
        thread.join()
    # only the calls that the process was answering
    assert statuses["broken"] <= len(threads)
    assert statuses.keys() <= {200, "broken"}
    assert other.is_running()
    wait_until(lambda: _all_ready(live), NET_S)
    _sees_a_dead_process_in_its_counts(live)


def _sees_a_dead_process_in_its_counts(live: Live) -> None:
    with live.client() as client:
        found = _families(client)
    assert found["http_requests_total"]["/v1/search/motion"] > 10
    living = {str(process.pid) for process in _processes(live)}
    assert found["process_resident_memory_bytes"].keys() <= living


def test_who_signs_in_is_known_everywhere_and_rates_are_shared(live: Live) -> None:
    """The last test: from here on, calls need a key."""
    settings = Settings(data_dir=live.data_dir)
    store = Store.open(settings.database, settings.files_dir)
    with store.write() as tx:
        made = keys.create(tx, KeyRole.READ, "read")
    store.close()
    own = {"Origin": live.url, "Sec-Fetch-Site": "same-origin"}
    with live.client(headers=own) as page:
        cookie = page.post("/v1/session", json={"key": made.secret}).headers["set-cookie"]
    headers = own | {"Cookie": cookie.partition(";")[0]}

    def listed(client: httpx2.Client) -> object:
        answer = client.get("/v1/clips", headers=headers)
        return answer.status_code, int(answer.headers["RateLimit"].partition("r=")[2].split(";")[0])

    answers = _everywhere(live, listed)
    assert {status for status, _ in answers} == {200}  # type: ignore[misc]
    assert len({left for _, left in answers}) == CONNECTIONS  # type: ignore[misc]
    with live.client(headers=headers) as page:
        assert page.delete("/v1/session").status_code == 204
    signed_out = _everywhere(live, lambda c: c.get("/v1/clips", headers=headers).status_code)
    assert set(signed_out) == {401}


def test_a_taken_port_is_refused_before_any_process_starts(live: Live) -> None:
    port = int(live.url.rpartition(":")[2])
    with pytest.raises(ConfigurationError):
        ApiProcesses(Settings(data_dir=live.data_dir, port=port, processes=2))


def test_one_process_listens_itself(tmp_path: Path) -> None:
    with ApiProcesses(Settings(data_dir=tmp_path)).all() as processes:
        assert [(one.name, one.files) for one in processes] == [("api", ())]
