"""Answers in pieces: they give slots back while a client reads, and cut slow clients off."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from app.api import pieces
from app.api.failures.problems import CLIENT_LEFT, TooBusy
from app.api.guard.envelope import CutOff
from app.api.guard.gates import Counter, Gate, Gates
from app.api.pieces import Pieces
from app.deadline import current
from app.errors import BadField

Message = dict[str, Any]


def run(test: Callable[[], Coroutine[Any, Any, None]]) -> None:
    asyncio.run(asyncio.wait_for(test(), 300))


def one_slot(seconds: float = 60.0, streams: int = 4) -> Gates:
    return replace(
        Gates.of(seconds), heavy=Gate("heavy", 1, 1), streams=Counter("answers", streams)
    )


class Client:
    """A client that reads everything, or `takes` messages until `may_send` is set."""

    def __init__(self, gates: Gates, takes: int | None = None) -> None:
        self.gates = gates
        self.takes = takes
        self.sent: list[Message] = []
        self.may_send = asyncio.Event()
        self.may_send.set()
        self.leaves = asyncio.Event()

    async def read(self, content: Iterator[bytes | str]) -> None:
        app = SimpleNamespace(state=SimpleNamespace(gates=self.gates))
        answer = Pieces(content, media_type="text/plain")
        await answer({"type": "http", "app": app}, self._receive, self._send)

    @property
    def body(self) -> bytes:
        return b"".join(message.get("body", b"") for message in self.sent)

    async def _receive(self) -> Message:
        await self.leaves.wait()
        return {"type": "http.disconnect"}

    async def _send(self, message: Message) -> None:
        await self.may_send.wait()
        self.sent.append(message)
        if len(self.sent) == self.takes:
            self.may_send.clear()


async def until(look: Callable[[], bool]) -> None:
    while not look():
        await asyncio.sleep(0.005)


def test_pieces_come_in_order_and_end() -> None:
    async def test() -> None:
        client = Client(one_slot())
        await client.read(iter([b"ab", "cd", b""]))
        assert client.body == b"abcd"
        assert client.sent[0]["status"] == 200
        assert [m.get("more_body") for m in client.sent] == [None, True, True, False]
        assert client.gates.heavy._free == 1

    run(test)


def test_a_large_piece_is_sent_in_parts() -> None:
    async def test() -> None:
        client, content = Client(one_slot()), bytes(range(256)) * 4096
        await client.read(iter([content]))
        assert client.body == content
        assert max(len(m.get("body", b"")) for m in client.sent) == pieces.MAX_PART_BYTES

    run(test)


def test_a_client_that_reads_nothing_holds_no_slot() -> None:
    async def test() -> None:
        client = Client(one_slot(), takes=3)
        reading = asyncio.create_task(client.read(iter([b"x"] * 50)))
        await until(lambda: len(client.sent) == 3)
        await until(lambda: client.gates.heavy._free == 1)
        assert not reading.done()
        client.may_send.set()
        await reading
        assert client.body == b"x" * 50

    run(test)


def test_a_client_that_reads_too_slowly_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces, "GRACE_SECONDS", 0.1)

    async def test() -> None:
        client = Client(one_slot(), takes=3)
        reading = asyncio.create_task(client.read(iter([b"x"] * 50)))
        with pytest.raises(CutOff) as cut:
            await reading
        assert cut.value.status == 408
        assert client.gates.heavy._free == 1

    run(test)


def test_the_time_in_which_a_client_reads_does_not_count() -> None:
    async def test() -> None:
        client = Client(one_slot(seconds=0.1), takes=3)
        reading = asyncio.create_task(client.read(iter([b"x"] * 50)))
        await until(lambda: len(client.sent) == 3)
        await asyncio.sleep(0.3)
        client.may_send.set()
        await reading
        assert client.body == b"x" * 50

    run(test)


def test_an_answer_and_its_pieces_end_when_the_client_leaves() -> None:
    async def test() -> None:
        client = Client(one_slot())
        made: list[int] = []

        def endless() -> Iterator[bytes]:
            while True:
                assert current() is not None
                made.append(1)
                yield b"x" * 1000

        reading = asyncio.create_task(client.read(endless()))
        await until(lambda: len(made) > 3)
        client.leaves.set()
        with pytest.raises(CutOff) as cut:
            await reading
        assert cut.value.status == CLIENT_LEFT
        assert client.gates.heavy._free == 1

    run(test)


def test_a_failure_before_the_first_piece_can_be_answered() -> None:
    async def test() -> None:
        def failing() -> Iterator[bytes]:
            raise BadField("too much")
            yield b""

        client = Client(one_slot())
        with pytest.raises(BadField):
            await client.read(failing())
        assert client.sent == []

    run(test)


def test_too_many_answers_at_once_are_refused() -> None:
    async def test() -> None:
        gates = one_slot(streams=1)
        first, second = Client(gates, takes=2), Client(gates)
        reading = asyncio.create_task(first.read(iter([b"x"] * 50)))
        await until(lambda: len(first.sent) == 2)
        with pytest.raises(TooBusy):
            await second.read(iter([b"y"]))
        first.may_send.set()
        await reading
        await second.read(iter([b"y"]))
        assert second.body == b"y"

    run(test)


def test_two_long_answers_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces, "TURN_SECONDS", 0.0)

    async def test() -> None:
        gates = one_slot()
        made: list[str] = []

        def of(name: str) -> Iterator[bytes]:
            for _ in range(5):
                made.append(name)
                yield name.encode()

        await asyncio.gather(Client(gates).read(of("a")), Client(gates).read(of("b")))
        assert made[:6] == ["a", "b", "a", "b", "a", "b"]

    run(test)
