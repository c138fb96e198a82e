"""Clients that read an answer slowly or not at all: they block nobody, and lose no bytes."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from urllib.parse import urlsplit

import httpx2
import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from app.api.guard import protocol, reader
from app.api.guard.connections import Connections
from app.api.guard.protocol import GuardedProtocol
from tests.live import NET_S, Live, serve, wait_until

BODY = b"x" * 20_000_000
"""More bytes than the buffers of a connection can hold."""
KEEP, CLOSE = (
    b"GET / HTTP/1.1\r\nHost: x\r\n%s\r\n" % more for more in (b"", b"Connection: close\r\n")
)
NET_SECONDS = 30.0
"""Time limit of a test. It is reached only if the test fails."""

Stream = tuple[asyncio.StreamReader, asyncio.StreamWriter]
Connect = Callable[[], Awaitable[Stream]]


async def _whole(scope: Scope, receive: Receive, send: Send) -> None:
    headers = [(b"content-length", b"%d" % len(BODY))]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": BODY})


async def _in_pieces(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    for first in range(0, len(BODY), 65_536):
        piece = BODY[first : first + 65_536]
        await send({"type": "http.response.body", "body": piece, "more_body": True})
    await send({"type": "http.response.body", "body": b""})


def _served(
    application: Callable[[Scope, Receive, Send], Awaitable[None]],
    talk: Callable[[Connect, Connections], Awaitable[None]],
) -> None:
    """Have `talk` with the application, behind a server with room for one connection."""

    async def run() -> None:
        config = uvicorn.Config(
            application, log_config=None, access_log=False, timeout_keep_alive=0
        )
        config.load()
        connections = Connections(1, 1)
        make = partial(GuardedProtocol, config, ServerState(), {}, connections=connections)
        server = await asyncio.get_running_loop().create_server(make, "127.0.0.1", 0)
        opened: list[asyncio.StreamWriter] = []

        async def connect() -> Stream:
            stream = await asyncio.open_connection(*server.sockets[0].getsockname())
            opened.append(stream[1])
            return stream

        async with server:
            await asyncio.wait_for(talk(connect, connections), NET_SECONDS)
            for writer in opened:
                writer.transport.abort()

    asyncio.run(run())


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "LOOK_SECONDS", 0.05)
    monkeypatch.setattr(protocol, "LINGER_SECONDS", 0.05)


@pytest.mark.parametrize("application", [_whole, _in_pieces])
def test_a_client_that_reads_nothing_is_closed_for_another(
    monkeypatch: pytest.MonkeyPatch, application: Callable[..., Awaitable[None]]
) -> None:
    monkeypatch.setattr(reader, "STALLED_SECONDS", 0.1)

    async def talk(connect: Connect, connections: Connections) -> None:
        _, idle = await connect()
        idle.write(KEEP)
        await idle.drain()
        while True:  # until the other one has room
            read, write = await connect()
            write.write(KEEP)
            if b" 200 " in await read.readline():
                return
            await asyncio.sleep(0.05)

    _served(application, talk)


@pytest.mark.parametrize("application", [_whole, _in_pieces])
@pytest.mark.parametrize("request_", [KEEP, CLOSE])
def test_a_client_that_reads_nothing_is_cut_off(
    monkeypatch: pytest.MonkeyPatch,
    application: Callable[..., Awaitable[None]],
    request_: bytes,
) -> None:
    monkeypatch.setattr(reader, "GONE_SECONDS", 0.3)

    async def talk(connect: Connect, connections: Connections) -> None:
        _, write = await connect()
        write.write(request_)
        while not len(connections):
            await asyncio.sleep(0.01)
        while len(connections):
            await asyncio.sleep(0.01)

    _served(application, talk)


@pytest.mark.parametrize("application", [_whole, _in_pieces])
def test_a_slow_client_gets_the_whole_answer(application: Callable[..., Awaitable[None]]) -> None:
    async def talk(connect: Connect, connections: Connections) -> None:
        read, write = await connect()
        write.write(KEEP)
        got = 0
        while got < len(BODY) and (piece := await read.read(2**16)):
            got += len(piece)
            await asyncio.sleep(0.005)
        assert got >= len(BODY)

    _served(application, talk)


@pytest.mark.slow
def test_clients_that_do_not_read_files_block_nobody(tmp_path: Path) -> None:
    with serve(tmp_path / "data", max_connections_per_address=8) as live, ExitStack() as held:
        with live.client() as client:
            files = {"file": ("large.bvh", b"HIERARCHY\n" + BODY)}
            clip = client.post("/v1/clips", files=files).json()["clip"]["id"]
        for _ in range(8):
            _ask(live, held, f"/v1/clips/{clip}/file")
        wait_until(lambda: _is_alive(live), NET_S)


def _ask(live: Live, held: ExitStack, path: str) -> None:
    address = urlsplit(live.url)
    place = (address.hostname, address.port)
    line = held.enter_context(closing(socket.create_connection(place, timeout=300)))
    line.sendall(f"GET {path} HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode())
    assert line.recv(12) == b"HTTP/1.1 200"


def _is_alive(live: Live) -> bool:
    try:
        with live.client() as client:
            return client.get("/livez").status_code == 200
    except httpx2.TransportError:
        return False
