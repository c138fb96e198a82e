"""Gates: how many calls of a kind work at once, how many wait, and for how long.

A call of a gate's kind takes a slot before its thread starts and gives it back when it is
done. Who finds the waiting room full is refused at once (TooBusy). So calls that take long
never hold the threads that quick ones need, and a queue never grows without bound.

While a call waits and works, its deadline runs (`app.deadline`), and we listen for the
client: when it leaves, the call loses its place in the queue, or its work is told to stop.

The gates of an application are used by its one event loop only, so there are no locks.
"""

from __future__ import annotations

import asyncio
import math
import os
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass

from starlette.exceptions import HTTPException
from starlette.types import Receive

from app.api.failures.problems import TooBusy
from app.deadline import Deadline, within
from app.errors import ClientLeft, DeadlineExceeded

MOST_HEAVY = 16
"""Heavy calls at once, however many cores there are: Python runs them one after the other."""
FEWEST_HEAVY = 2
"""So that one that waits for a child process, or for the disk, does not stop all others."""
WAITING_PER_HEAVY = 16
"""Heavy calls that wait for each one that works."""
QUICK, CHANGES = 16, 8
"""Quick calls, and calls that write, at once."""
WAITING = 256
"""Quick calls that wait, and as many that write."""
MOST_STREAMS = 32
"""Answers in pieces that are open at once: each holds its motion in memory."""
MOST_FOLLOWERS = 256
"""Jobs that are followed at once."""
SPARE_THREADS = 16
"""For what is done before a gate and behind it: keys are checked, pieces of files are sent."""


class Slot:
    """A place at a gate, for one call; it may be given back and taken again meanwhile."""

    def __init__(self, gate: Gate, deadline: Deadline, left: asyncio.Future[None]) -> None:
        self._gate = gate
        self._deadline = deadline
        self._left = left
        self._is_held = False

    async def take(self, *, again: bool = False) -> None:
        """Wait for a place. `again`: the call has begun, and cannot be refused any more.

        Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        if not self._is_held:
            await self._gate.enter(self._deadline, self._left, again=again)
            self._is_held = True

    async def share(self) -> None:
        """Let one that waits go first. Raises as `take`."""
        if self._gate.waiting:
            self.give_back()
            await self.take(again=True)

    def give_back(self) -> None:
        """Let the next one in; nothing where no place is held."""
        if self._is_held:
            self._is_held = False
            self._gate.leave()


class Gate:
    """So many calls work at once, and so many wait for their turn, in the order they came."""

    def __init__(self, name: str, slots: int, waiting: int) -> None:
        self.name = name
        self.slots = slots
        self._free = slots
        self._room = waiting
        self._turns: deque[asyncio.Future[None]] = deque()

    @property
    def waiting(self) -> int:
        """Calls that wait."""
        return len(self._turns)

    async def enter(
        self, deadline: Deadline, left: asyncio.Future[None], *, again: bool = False
    ) -> None:
        """Take a slot, after those that came before. left: is done when the client leaves.

        Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        if self._free and not self._turns:
            self._free -= 1
            return
        if len(self._turns) >= self._room and not again:
            raise TooBusy(f"Too many {self.name} calls are waiting; try again shortly.")
        turn = asyncio.get_running_loop().create_future()
        self._turns.append(turn)
        try:
            await _first_of(turn, left, deadline.remaining())
        except BaseException:
            self._forgo(turn)
            raise

    def leave(self) -> None:
        """Give a slot to the one that waits longest, or back."""
        if self._turns:
            self._turns.popleft().set_result(None)
        else:
            self._free += 1

    def _forgo(self, turn: asyncio.Future[None]) -> None:
        if turn.done():
            self.leave()
        else:
            self._turns.remove(turn)

    @asynccontextmanager
    async def admitted(self, receive: Receive, seconds: float) -> AsyncIterator[None]:
        """Hold a slot for the block, whose work has a deadline and ends when the client leaves.

        receive: of a request whose body was read. Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        deadline = Deadline(seconds)
        async with listening(receive, deadline) as left:
            slot = Slot(self, deadline, left)
            try:
                await slot.take()
                with within(deadline):
                    yield
            finally:
                # What still works in a thread now, because this task was cancelled, is to stop.
                deadline.abandon()
                slot.give_back()


class Counter:
    """So many at once, and no more."""

    def __init__(self, name: str, most: int) -> None:
        self._name = name
        self._free = most

    @asynccontextmanager
    async def one(self) -> AsyncIterator[None]:
        """Count as one for the block. Raises TooBusy."""
        if not self._free:
            raise TooBusy(f"Too many {self._name}; try again shortly.")
        self._free -= 1
        try:
            yield
        finally:
            self._free += 1


@dataclass(frozen=True)
class Gates:
    """What stands before the calls of an application; seconds: a call's time limit.

    heavy: what computes for long, searches before all; quick: what reads a few rows; changes:
    what writes, and may wait for other writers; streams: answers that are sent in pieces;
    followers: of jobs.
    """

    heavy: Gate
    quick: Gate
    changes: Gate
    streams: Counter
    followers: Counter
    seconds: float

    @classmethod
    def of(cls, seconds: float) -> Gates:
        """The gates for this machine's cores."""
        cores = len(os.sched_getaffinity(0))
        heavy = min(max(cores, FEWEST_HEAVY), MOST_HEAVY)
        return cls(
            heavy=Gate("heavy", heavy, WAITING_PER_HEAVY * heavy),
            quick=Gate("quick", QUICK, WAITING),
            changes=Gate("changing", CHANGES, WAITING),
            streams=Counter("answers are being read", MOST_STREAMS),
            followers=Counter("jobs are being followed", MOST_FOLLOWERS),
            seconds=seconds,
        )

    @property
    def threads(self) -> int:
        """Threads that are enough for all who are let in, and some more."""
        return self.heavy.slots + self.quick.slots + self.changes.slots + SPARE_THREADS


@asynccontextmanager
async def listening(receive: Receive, deadline: Deadline) -> AsyncIterator[asyncio.Future[None]]:
    """Abandon the work of a deadline as soon as the client leaves; then what is given is done."""
    left = asyncio.ensure_future(_until_left(receive, deadline))
    try:
        yield left
    finally:
        left.cancel()


async def _until_left(receive: Receive, deadline: Deadline) -> None:
    # A body that nobody asked for and that is too large ends the listening, not the call.
    with suppress(HTTPException):
        while (await receive())["type"] != "http.disconnect":
            pass
        deadline.abandon()
        return
    await asyncio.sleep(math.inf)


async def _first_of(turn: asyncio.Future[None], left: asyncio.Future[None], seconds: float) -> None:
    """Wait for the turn. Raises ClientLeft, DeadlineExceeded."""
    timeout = None if math.isinf(seconds) else seconds
    await asyncio.wait({turn, left}, timeout=timeout, return_when=asyncio.FIRST_COMPLETED)
    if turn.done():
        return
    if left.done():
        raise ClientLeft
    raise DeadlineExceeded(
        "The call waited in vain for its turn: the service is too busy; try again shortly."
    )
