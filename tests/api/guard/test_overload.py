"""Long searches, slow readers and clients that leave do not block the service."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.api.guard.gates import MAX_STREAMS, Gates
from app.api.streams import OCTETS
from tests.api.conftest import assert_problem
from tests.bench.processes import processes_over
from tests.live import Live, serve, wait_until
from tests.long_clips import FRAMES, long_library

PATIENCE_SECONDS = 60.0
"""A generous limit, because the machine may be busy."""
IDLE_CPU_SECONDS = 0.1
"""CPU time of an idle process between two looks, at most. A working one uses the whole time."""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    data_dir = tmp_path_factory.mktemp("overload") / "data"
    return data_dir, long_library(data_dir)


@pytest.fixture(scope="module")
def live(library: tuple[Path, list[str]]) -> Iterator[Live]:
    """A service whose time limit is so long that no call ends because of it."""
    with serve(library[0], request_timeout_s=600) as running:
        yield running


@pytest.fixture
def client(live: Live) -> Iterator[httpx2.Client]:
    with live.client() as opened:
        yield opened


def _endless(library: tuple[Path, list[str]]) -> dict[str, Any]:
    return {"clip_id": library[1][0], "method": "msv-dtw"}


@contextmanager
def _asked(live: Live, method: str, path: str, body: Any = None) -> Iterator[socket.socket]:
    """A request of a client that reads nothing, and leaves when the block ends."""
    content = b"" if body is None else json.dumps(body).encode()
    head = [f"{method} {path} HTTP/1.1", "Host: 127.0.0.1", f"Content-Length: {len(content)}"]
    head += [f"Accept: {OCTETS}"]
    head += [] if body is None else ["Content-Type: application/json"]
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(PATIENCE_SECONDS)
        connection.connect(("127.0.0.1", int(live.url.rpartition(":")[2])))
        connection.sendall("\r\n".join([*head, "", ""]).encode() + content)
        yield connection


def _status(connection: socket.socket, seconds: float = PATIENCE_SECONDS) -> int | None:
    """The status of the answer, or None if there is no answer yet."""
    connection.settimeout(seconds)
    try:
        return int(connection.recv(12).split()[1])
    except TimeoutError:
        return None


def _cpu_seconds(live: Live) -> float:
    times = [process.cpu_times() for process in processes_over(live.data_dir)]
    return float(sum(one.user + one.system for one in times))


def _wait_until_idle(live: Live) -> None:
    seen = [_cpu_seconds(live)]

    def is_idle() -> bool:
        time.sleep(0.5)
        seen.append(_cpu_seconds(live))
        return seen[-1] - seen[-2] < IDLE_CPU_SECONDS

    wait_until(is_idle, PATIENCE_SECONDS)


def _answers(client: httpx2.Client, clip_id: str) -> list[int]:
    """The statuses of calls that must always work: health, lists, metrics."""
    paths = ("/livez", "/readyz", "/v1/clips", f"/v1/clips/{clip_id}", "/v1/jobs", "/metrics")
    return [client.get(path).status_code for path in paths]


def test_a_search_that_takes_too_long_ends_and_its_work_stops(
    library: tuple[Path, list[str]],
) -> None:
    with serve(library[0], request_timeout_s=1) as hasty, hasty.client() as client:
        answer = client.post("/v1/search/motion", json=_endless(library))
        assert_problem(answer, 503, "deadline_exceeded")
        assert int(answer.headers["retry-after"]) >= 1
        _wait_until_idle(hasty)


def test_more_searches_than_can_wait_are_refused_and_the_others_stop_when_their_clients_leave(
    live: Live, client: httpx2.Client, library: tuple[Path, list[str]]
) -> None:
    heavy = Gates.of(1.0).heavy
    room = heavy.slots + heavy._room
    with ExitStack() as stack:
        asked = [
            stack.enter_context(_asked(live, "POST", "/v1/search/motion", _endless(library)))
            for _ in range(room + 8)
        ]
        refused = client.post("/v1/search/motion", json=_endless(library))
        assert_problem(refused, 503, "too_busy")
        assert int(refused.headers["retry-after"]) >= 1
        assert _answers(client, library[1][0]) == [200] * 6
        statuses = [_status(connection, 0.01) for connection in asked]
        assert statuses.count(None) == room
        assert statuses.count(503) == 8
    plain = {"clip_id": library[1][0], "method": "vector"}
    answer = wait_until(lambda: _ok(client.post("/v1/search/motion", json=plain)), PATIENCE_SECONDS)
    assert len(answer.json()["items"]) == 2
    _wait_until_idle(live)


def _ok(answer: httpx2.Response) -> httpx2.Response | None:
    return answer if answer.status_code == 200 else None


def test_clients_that_read_nothing_block_nobody(
    live: Live, client: httpx2.Client, library: tuple[Path, list[str]]
) -> None:
    clip_id = library[1][0]
    path = f"/v1/clips/{clip_id}/motion"
    with ExitStack() as stack:
        readers = [stack.enter_context(_asked(live, "GET", path)) for _ in range(MAX_STREAMS + 8)]
        statuses = [_status(reader) for reader in readers]
        assert statuses.count(200) == MAX_STREAMS
        assert statuses.count(503) == 8
        assert _answers(client, clip_id) == [200] * 6
        plain = {"clip_id": clip_id, "method": "vector"}
        assert client.post("/v1/search/motion", json=plain).status_code == 200
    octets = {"Accept": OCTETS}
    whole = wait_until(lambda: _ok(client.get(path, headers=octets)), PATIENCE_SECONDS)
    assert len(whole.content) == FRAMES * 13 * 3 * 4
    _wait_until_idle(live)


@pytest.mark.parametrize("fps", ["0.01", "0.0001", "0.999", "1e-131", "1e-300", "5e-324", "1001"])
def test_a_frame_rate_outside_the_limits_is_refused(
    client: httpx2.Client, library: tuple[Path, list[str]], fps: str
) -> None:
    clip = f"/v1/clips/{library[1][0]}"
    for path in ("motion", "export?format=csv", "low-dimensional?basis=uniform&poses=9"):
        separator = "&" if "?" in path else "?"
        answer = client.get(f"{clip}/{path}{separator}fps={fps}")
        assert_problem(answer, 422, "bad_field", "query.fps")


def test_more_frames_than_a_call_may_make_are_refused(
    client: httpx2.Client, library: tuple[Path, list[str]]
) -> None:
    answer = client.get(f"/v1/clips/{library[1][0]}/motion?fps=1000")
    assert_problem(answer, 422, "bad_field", "query.fps")
    assert "more than 500000 frames" in answer.json()["detail"]


def test_a_json_body_has_a_smaller_limit_than_a_file(client: httpx2.Client) -> None:
    for path in ("/v1/search/motion", "/v1/recognize"):
        answer = client.post(path, json={"clip_id": "x" * 2_000_000})
        assert_problem(answer, 413, "too_large")
