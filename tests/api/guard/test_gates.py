"""Gates: calls that work, wait, are refused, or end early."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

import pytest

from app.api.failures.problems import TooBusy
from app.api.guard.gates import Counter, Gate, Gates, Slot, listening
from app.deadline import Deadline, check, current
from app.errors import ClientLeft, DeadlineExceeded

Receive = Callable[[], Awaitable[dict[str, Any]]]


def run(test: Callable[[], Coroutine[Any, Any, None]]) -> None:
    asyncio.run(asyncio.wait_for(test(), 300))


async def stays() -> dict[str, Any]:
    """The `receive` of a client that waits for its answer."""
    await asyncio.sleep(3600)
    return {"type": "http.disconnect"}


def leaves(when: asyncio.Event) -> Receive:
    async def receive() -> dict[str, Any]:
        await when.wait()
        return {"type": "http.disconnect"}

    return receive


class Calls:
    """Calls that work until their event in `ends` is set."""

    def __init__(self, gate: Gate, seconds: float = 60.0) -> None:
        self.gate = gate
        self.seconds = seconds
        self.working: list[str] = []
        self.ends: dict[str, asyncio.Event] = {}

    def begin(self, name: str, receive: Receive = stays) -> asyncio.Task[None]:
        self.ends[name] = asyncio.Event()
        return asyncio.create_task(self._call(name, receive))

    async def _call(self, name: str, receive: Receive) -> None:
        async with self.gate.admitted(receive, self.seconds):
            self.working.append(name)
            await self.ends[name].wait()
            self.working.remove(name)


async def settle() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


def test_waiting_calls_follow_in_the_order_in_which_they_came() -> None:
    async def test() -> None:
        calls = Calls(Gate("heavy", slots=2, waiting=5))
        tasks = {name: calls.begin(name) for name in "abcd"}
        await settle()
        assert calls.working == ["a", "b"]
        assert calls.gate.waiting == 2
        calls.ends["b"].set()
        await settle()
        assert calls.working == ["a", "c"]
        for end in calls.ends.values():
            end.set()
        await asyncio.gather(*tasks.values())
        assert calls.gate.waiting == 0

    run(test)


def test_a_call_is_refused_at_once_if_the_queue_is_full() -> None:
    async def test() -> None:
        calls = Calls(Gate("heavy", slots=1, waiting=1))
        begun = [calls.begin("a"), calls.begin("b")]
        await settle()
        with pytest.raises(TooBusy, match="heavy"):
            await calls.begin("c")
        for task in begun:
            task.cancel()

    run(test)


def test_a_call_whose_client_leaves_the_queue_never_works() -> None:
    async def test() -> None:
        calls, gone = Calls(Gate("heavy", slots=1, waiting=1)), asyncio.Event()
        calls.begin("a")
        await settle()
        left = calls.begin("b", leaves(gone))
        await settle()
        gone.set()
        with pytest.raises(ClientLeft):
            await left
        assert calls.gate.waiting == 0
        calls.ends["a"].set()
        await settle()
        assert calls.working == []

    run(test)


def test_a_call_that_waits_too_long_exceeds_its_deadline() -> None:
    async def test() -> None:
        calls = Calls(Gate("heavy", slots=1, waiting=1), seconds=0.05)
        calls.begin("a")
        await settle()
        with pytest.raises(DeadlineExceeded):
            await calls.begin("b")
        assert calls.gate.waiting == 0

    run(test)


def test_a_cancelled_call_passes_its_turn_to_the_next() -> None:
    async def test() -> None:
        calls = Calls(Gate("heavy", slots=1, waiting=2))
        first, second = calls.begin("a"), calls.begin("b")
        calls.begin("c")
        await settle()
        calls.ends["a"].set()
        await first
        second.cancel()  # its turn may have come in this very moment
        await settle()
        assert calls.working == ["c"]

    run(test)


def test_work_has_a_deadline_and_ends_when_the_client_leaves() -> None:
    async def test() -> None:
        gate, gone = Gate("heavy", slots=1, waiting=1), asyncio.Event()

        async def call() -> None:
            async with gate.admitted(leaves(gone), 60.0):
                check()
                gone.set()
                await settle()
                check()

        with pytest.raises(ClientLeft):
            await call()
        assert current() is None
        async with gate.admitted(stays, 60.0):
            check()

    run(test)


def test_the_work_of_a_cancelled_call_is_stopped() -> None:
    async def test() -> None:
        seen: list[Deadline] = []

        async def call() -> None:
            async with Gate("heavy", slots=1, waiting=1).admitted(stays, 60.0):
                deadline = current()
                assert deadline is not None
                seen.append(deadline)
                await asyncio.sleep(3600)

        task = asyncio.create_task(call())
        await settle()
        task.cancel()
        await settle()
        with pytest.raises(ClientLeft):
            seen[0].check()

    run(test)


def test_a_call_that_has_begun_shares_its_slot_and_is_never_refused() -> None:
    async def test() -> None:
        gate = Gate("heavy", slots=1, waiting=1)
        async with listening(stays, Deadline()) as left:
            slot = Slot(gate, Deadline(60.0), left)
            await slot.take()
            calls = Calls(gate)
            calls.begin("a")
            await settle()
            assert calls.working == []
            sharing = asyncio.create_task(slot.share())
            await settle()
            assert calls.working == ["a"]
            assert not sharing.done()
            calls.ends["a"].set()
            await sharing
            slot.give_back()
            slot.give_back()  # nothing is held: nothing is given
            calls.begin("b")
            calls.begin("c")
            await settle()
            assert calls.working == ["b"]

    run(test)


def test_a_counter_refuses_more_than_its_limit() -> None:
    async def test() -> None:
        counter = Counter("answers", 1)
        async with counter.one():
            with pytest.raises(TooBusy, match="answers"):
                async with counter.one():
                    pass
        async with counter.one():
            pass

    run(test)


def test_there_are_enough_threads_for_all_slots() -> None:
    gates = Gates.of(30.0)
    assert gates.threads > gates.heavy.slots + gates.quick.slots + gates.changes.slots
    assert 2 <= gates.heavy.slots <= 16
