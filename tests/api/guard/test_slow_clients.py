"""Clients that send slowly, or only a part of a request: they block nobody else."""

from __future__ import annotations

import asyncio
import resource
import socket
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from app.api.failures.problems import TooBusy
from app.api.guard import arrival, protocol
from app.api.guard.connections import Connections
from app.api.guard.protocol import GuardedProtocol
from app.api.guard.slots import Slots
from tests.api.conftest import assert_problem
from tests.live import NET_S, Live, serve, wait_until

HALF = b"GET /v1/clips HTTP/1.1\r\nHost: localhost\r\nX-Half: "
FORM = {"Content-Type": "multipart/form-data; boundary=x"}
BEGIN = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.bvh"\r\n\r\nHIERARCHY\n'
SEARCH, CLIPS = "/v1/search/motion", "/v1/clips"


@contextmanager
def lines_to(live: Live, count: int) -> Iterator[list[socket.socket]]:
    """Bare connections to the API."""
    address = urlsplit(live.url)
    with ExitStack() as held:
        yield [
            held.enter_context(
                closing(socket.create_connection((address.hostname, address.port), timeout=300))
            )
            for _ in range(count)
        ]


def is_closed(line: socket.socket) -> bool:
    """Whether the server has closed it, after an answer or without one."""
    line.settimeout(0.01)
    try:
        while line.recv(65536):
            pass
    except TimeoutError:
        return False
    except OSError:
        pass
    return True


def begin_form(live: Live, line: socket.socket, path: str) -> None:
    host = urlsplit(live.url).netloc
    head = f"POST {path} HTTP/1.1\r\nHost: {host}\r\nContent-Type: {FORM['Content-Type']}\r\n"
    line.sendall(head.encode() + b"Content-Length: 90000000\r\n\r\n" + BEGIN)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A service with room for 20 connections from one address, and two uploads of each kind."""
    data = tmp_path_factory.mktemp("small") / "data"
    with serve(data, max_connections_per_address=20, max_concurrent_uploads=2) as live:
        yield live


def test_half_sent_headers_make_room_for_others(small: Live) -> None:
    with lines_to(small, 60) as lines:
        for line in lines:
            line.sendall(HALF)
        with small.client() as client:
            assert client.get("/livez").status_code == 200
            assert client.get("/v1/clips").status_code == 200
        wait_until(lambda: all(is_closed(line) for line in lines[:40]), NET_S)
        assert not any(is_closed(line) for line in lines[-10:])


@pytest.mark.slow
def test_a_thousand_half_sent_headers_from_one_address(tmp_path: Path) -> None:
    # Without our limits, the process would use up its file descriptors here.
    with (
        _soft_limit_of_files(1024),
        serve(tmp_path / "data") as live,
        _soft_limit_of_files(4096),
        lines_to(live, 1_100) as lines,
    ):
        for line in lines:
            line.sendall(HALF)
        with live.client() as client:
            assert client.get("/livez").status_code == 200
            answer = client.post(SEARCH, json={"clip_id": "x"})
            assert_problem(answer, 404, "clip_not_found")
        wait_until(lambda: all(is_closed(line) for line in lines), NET_S)


@contextmanager
def _soft_limit_of_files(count: int) -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(count, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_connections_with_a_running_call_are_not_closed(small: Live, take: Any) -> None:
    job = small.upload(take).json()["job"]["id"]
    host = urlsplit(small.url).netloc
    with lines_to(small, 20) as lines:
        for line in lines:
            line.sendall(f"GET /v1/jobs/{job}/events HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
            assert line.recv(15).startswith(b"HTTP/1.1 200")
        with lines_to(small, 1) as (refused,):
            answer = b"".join(iter(lambda: refused.recv(65536), b""))
        assert answer.startswith(b"HTTP/1.1 503")
        assert b"too_many_connections" in answer
    wait_until(lambda: _is_alive(small), NET_S)


def _is_alive(live: Live) -> bool:
    with live.client() as client:
        return bool(client.get("/livez").status_code == 200)


def test_slow_searches_block_neither_uploads_nor_searches(small: Live) -> None:
    with lines_to(small, 8) as lines, small.client() as client:
        for line in lines:
            begin_form(small, line, SEARCH)
        stored = client.post(CLIPS, content=BEGIN + b"stored\r\n--x--\r\n", headers=FORM)
        assert stored.status_code == 202
        assert client.post(SEARCH, json={"clip_id": "x"}).status_code == 404
        asked = client.post(SEARCH, content=BEGIN + b"asked\r\n--x--\r\n", headers=FORM)
        assert asked.status_code == 422
        wait_until(lambda: sum(map(is_closed, lines)) == 6, NET_S)
        # Two bodies are received. After a while, the slower one loses its slot to a new body.
        wait_until(lambda: _begin_another(small) and sum(map(is_closed, lines)) == 7, NET_S)


def _begin_another(live: Live) -> bool:
    with lines_to(live, 1) as (line,):
        begin_form(live, line, SEARCH)
        time.sleep(0.2)
    return True


class Slow(arrival.Arrival):
    """A body that is `seconds` behind its rate."""

    def __init__(self, seconds: float, is_slow: bool) -> None:
        super().__init__()
        self.seconds, self._is_slow, self.has_left = seconds, is_slow, False

    def behind(self) -> float:
        return self.seconds

    def is_slow(self) -> bool:
        return self._is_slow

    def give_up(self) -> None:
        self.has_left = True


def test_the_slowest_body_loses_its_slot() -> None:
    slots = Slots(3)
    slow, slower, quick = Slow(3.0, True), Slow(5.0, True), Slow(9.0, False)
    with ExitStack() as held:
        for body in (slow, slower, quick):
            held.enter_context(slots.one(body))
        held.enter_context(slots.one(Slow(1.0, False)))
        assert [body.has_left for body in (slow, slower, quick)] == [False, True, False]
        held.enter_context(slots.one(Slow(1.0, False)))
        assert slow.has_left
        with pytest.raises(TooBusy), slots.one(Slow(1.0, False)):
            pass


def test_small_bodies_that_come_slowly_are_bounded_too(small: Live) -> None:
    host = urlsplit(small.url).netloc
    head = f"POST /v1/search/words HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\n"
    with lines_to(small, 18) as lines, small.client() as client:
        for line in lines:
            line.sendall(head.encode() + b"Content-Length: 1000\r\n\r\n{")
        assert client.post("/v1/search/words", json={"words": ["walk"]}).status_code == 409


def test_json_has_a_small_limit_on_a_path_with_a_large_limit_for_forms(small: Live) -> None:
    with small.client() as client:
        answer = client.post(SEARCH, json={"clip_id": "x", "cursor": "c" * 2_000_000})
        assert_problem(answer, 413, "too_large")


# Tests with shortened time limits, on one connection in this process.


async def _application(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"done"})


async def _on_a_line(talk: Callable[[Any, Any], Awaitable[bytes]]) -> bytes:
    """Run `talk(reader, writer)` on a connection of the guarded protocol and return its result."""
    config = uvicorn.Config(_application, log_config=None, access_log=False)
    config.load()
    make = partial(GuardedProtocol, config, ServerState(), {}, connections=Connections(10, 10))
    server = await asyncio.get_running_loop().create_server(make, "127.0.0.1", 0)
    async with server:
        reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
        try:
            return await asyncio.wait_for(talk(reader, writer), 300)
        finally:
            writer.close()


def test_headers_that_take_too_long_are_answered_408(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol, "HEADER_SECONDS", 0.2)

    async def drip(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bytes:
        writer.write(HALF)
        # Read only the beginning: our bytes after the answer may reset the connection.
        answer = asyncio.ensure_future(reader.read(65536))
        while not answer.done():
            # Each byte comes soon, but all of them together take too long.
            writer.write(b"a")
            await asyncio.sleep(0.02)
        return await answer

    answer = asyncio.run(_on_a_line(drip))
    assert answer.startswith(b"HTTP/1.1 408 Request Timeout\r\n")
    assert b"urn:kinedex:problem:request_timeout" in answer


def test_a_client_that_sends_nothing_is_closed_without_an_answer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(protocol, "HEADER_SECONDS", 0.1)
    assert asyncio.run(_on_a_line(lambda reader, _: reader.read())) == b""


def test_the_time_begins_again_with_each_request(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol, "HEADER_SECONDS", 0.3)

    async def thrice(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bytes:
        for _ in range(3):
            writer.write(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
            await reader.readuntil(b"done")
            await asyncio.sleep(0.2)
        writer.write(HALF)
        return await reader.read()

    assert b" 408 " in asyncio.run(_on_a_line(thrice))


def test_bytes_that_are_not_http_are_answered_with_a_problem() -> None:
    async def garbage(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bytes:
        writer.write(b"\x16\x03\x01 this is no HTTP\r\n\r\n")
        return await reader.read()

    answer = asyncio.run(_on_a_line(garbage))
    assert answer.startswith(b"HTTP/1.1 400 Bad Request\r\n")
    assert b"application/problem+json" in answer
    assert b"x-content-type-options" in answer.lower()


def _arrive(pieces: list[tuple[float, int]]) -> arrival.Arrival:
    """Receive pieces: seconds to wait, then bytes."""
    body = arrival.Arrival()

    async def come() -> None:
        for seconds, size in pieces:

            async def receive(seconds: float = seconds, size: int = size) -> dict[str, Any]:
                await asyncio.sleep(seconds)
                return {"type": "http.request", "body": b"x" * size, "more_body": True}

            await body.next(receive)

    asyncio.run(come())
    return body


def test_a_body_must_arrive_at_a_minimum_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrival, "GRACE_SECONDS", 0.2)
    monkeypatch.setattr(arrival, "PAUSE_SECONDS", 10.0)
    monkeypatch.setattr(arrival, "MIN_BYTES_PER_SECOND", 1_000.0)
    _arrive([(0.05, 10_000)] * 10)
    with pytest.raises(arrival.TooSlow):
        _arrive([(0.05, 1)] * 10)


def test_a_fast_start_gives_a_body_no_extra_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrival, "GRACE_SECONDS", 0.2)
    monkeypatch.setattr(arrival, "FAIR_SECONDS", 0.1)
    assert not _arrive([(0.0, 10**8)]).is_slow()
    assert _arrive([(0.0, 10**8), (0.15, 1)]).is_slow()
    with pytest.raises(arrival.TooSlow):
        _arrive([(0.0, 10**8), *[(0.05, 1)] * 10])
    assert not _arrive([(0.15, 1), (0.0, 10**8)]).is_slow()


def test_a_late_body_can_lose_its_slot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(arrival, "PAUSE_SECONDS", 0.1)

    async def leave_late() -> None:
        body = arrival.Arrival()

        async def receive() -> dict[str, Any]:
            try:
                await asyncio.sleep(5)
            finally:
                body.give_up()
            return {}

        with pytest.raises(arrival.TooSlow):
            await body.next(receive)

    asyncio.run(leave_late())


def test_a_body_may_not_pause_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrival, "PAUSE_SECONDS", 0.1)
    with pytest.raises(arrival.TooSlow):
        _arrive([(0.0, 10**6), (5.0, 1)])


def test_only_time_in_which_we_wait_for_the_client_counts() -> None:
    body = _arrive([(0.0, 1)] * 3)
    time.sleep(0.05)
    assert body.behind() < 0.05
