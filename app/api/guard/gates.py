"""Gates: limits on how many calls of a kind work at once, how many wait, and for how long.

A call takes a slot of the gate for its kind before its thread starts, and gives the slot back
when it is done. If the queue of the gate is full, the call is refused at once (TooBusy). So long
calls never use the threads that quick calls need, and no queue grows without bound.

While a call waits and works, its deadline runs (`app.deadline`), and we listen for the client.
If the client leaves, the call is removed from the queue, or its deadline stops its work.

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

MAX_HEAVY = 16
"""Heavy calls at once, even with more cores: threads of Python compute one after the other."""
MIN_HEAVY = 2
"""Heavy calls at once, even with one core: one may only wait for a child process or the disk."""
MAX_WAITING_PER_HEAVY = 16
"""Length of the queue of heavy calls, for each slot."""
MAX_QUICK, MAX_CHANGES = 16, 8
"""Quick calls, and calls that write, at once."""
MAX_WAITING = 256
"""Length of the queue of quick calls, and of the queue of calls that write."""
MAX_STREAMS = 32
"""Answers in pieces at once: each holds its motion in memory."""
MAX_FOLLOWERS = 256
"""Clients that follow a job (`GET /v1/jobs/{id}/events`) at once."""
SPARE_THREADS = 16
"""Threads for work outside the gates: checks of keys, pieces of files."""


class Slot:
    """The slot of one call at a gate. The call may give it back and take it again."""

    def __init__(self, gate: Gate, deadline: Deadline, left: asyncio.Future[None]) -> None:
        self._gate = gate
        self._deadline = deadline
        self._left = left
        self._is_held = False

    async def take(self, *, again: bool = False) -> None:
        """Wait for a slot. `again`: the call has begun, so a full queue does not refuse it.

        Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        if not self._is_held:
            await self._gate.enter(self._deadline, self._left, again=again)
            self._is_held = True

    async def share(self) -> None:
        """Let a waiting call go first, if there is one. Raises what `take` raises."""
        if self._gate.waiting:
            self.give_back()
            await self.take(again=True)

    def give_back(self) -> None:
        """Give the slot to the next call. Does nothing if the slot is not held."""
        if self._is_held:
            self._is_held = False
            self._gate.leave()


class Gate:
    """A queue before a fixed number of slots.

    slots: calls that work at once; waiting: calls that may wait, in the order in which they came.
    """

    def __init__(self, name: str, slots: int, waiting: int) -> None:
        self.name = name
        self.slots = slots
        self._free = slots
        self._room = waiting
        self._turns: deque[asyncio.Future[None]] = deque()

    @property
    def waiting(self) -> int:
        """Number of calls that wait."""
        return len(self._turns)

    @property
    def is_full(self) -> bool:
        """Whether a call that comes now is refused."""
        return len(self._turns) >= self._room and not (self._free and not self._turns)

    def refusal(self) -> TooBusy:
        """The failure of a call that is refused."""
        return TooBusy(f"Too many {self.name} calls are waiting; try again shortly.")

    async def enter(
        self, deadline: Deadline, left: asyncio.Future[None], *, again: bool = False
    ) -> None:
        """Take a slot after the calls that came before. left: done when the client has left.

        Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        if self._free and not self._turns:
            self._free -= 1
            return
        if self.is_full and not again:
            raise self.refusal()
        turn = asyncio.get_running_loop().create_future()
        self._turns.append(turn)
        try:
            await _first_of(turn, left, deadline.remaining())
        except BaseException:
            # Also asyncio.CancelledError: a slot that nobody uses would be lost for good.
            self._forgo(turn)
            raise

    def leave(self) -> None:
        """Give the slot to the call that waits longest, or free it if no call waits."""
        if self._turns:
            self._turns.popleft().set_result(None)
        else:
            self._free += 1

    def _forgo(self, turn: asyncio.Future[None]) -> None:
        if turn.done():  # the slot was given to this call before it gave up
            self.leave()
        else:
            self._turns.remove(turn)

    @asynccontextmanager
    async def admitted(self, receive: Receive, seconds: float) -> AsyncIterator[None]:
        """Hold a slot for the block. Its work ends at the deadline, or when the client leaves.

        receive: that of a request whose body was read; seconds: the time limit.
        Raises TooBusy, DeadlineExceeded, ClientLeft.
        """
        deadline = Deadline(seconds)
        async with listening(receive, deadline) as left:
            slot = Slot(self, deadline, left)
            try:
                await slot.take()
                with within(deadline):
                    yield
            finally:
                # If this task was cancelled, its work may still run in a thread: stop it.
                deadline.abandon()
                slot.give_back()


class Counter:
    """A limit without a queue: at most `limit` blocks run at once."""

    def __init__(self, name: str, limit: int) -> None:
        self._name = name
        self._free = limit

    @asynccontextmanager
    async def one(self) -> AsyncIterator[None]:
        """Count the block as one. Raises TooBusy if the limit is reached."""
        if not self._free:
            raise TooBusy(f"Too many {self._name}; try again shortly.")
        self._free -= 1
        try:
            yield
        finally:
            self._free += 1


@dataclass(frozen=True)
class Gates:
    """The gates and limits of an application.

    heavy: calls that compute for long, mainly searches; quick: calls that read a few rows;
    changes: calls that write, and may wait for other writers; streams: answers in pieces;
    followers: clients that follow a job; seconds: the time limit of a call.
    """

    heavy: Gate
    quick: Gate
    changes: Gate
    streams: Counter
    followers: Counter
    seconds: float

    @classmethod
    def of(cls, seconds: float, processes: int = 1) -> Gates:
        """Make the gates of one of several processes that share the cores of this machine."""
        cores = -(-len(os.sched_getaffinity(0)) // processes)
        heavy = min(max(cores, MIN_HEAVY), MAX_HEAVY)
        return cls(
            heavy=Gate("heavy", heavy, MAX_WAITING_PER_HEAVY * heavy),
            quick=Gate("quick", MAX_QUICK, MAX_WAITING),
            changes=Gate("changing", MAX_CHANGES, MAX_WAITING),
            streams=Counter("answers are being read", MAX_STREAMS),
            followers=Counter("jobs are being followed", MAX_FOLLOWERS),
            seconds=seconds,
        )

    @property
    def threads(self) -> int:
        """Number of threads: enough for all slots and for the work outside the gates."""
        return self.heavy.slots + self.quick.slots + self.changes.slots + SPARE_THREADS


@asynccontextmanager
async def listening(receive: Receive, deadline: Deadline) -> AsyncIterator[asyncio.Future[None]]:
    """Abandon the work of a deadline when the client leaves. Then the yielded future is done."""
    left = asyncio.ensure_future(_until_left(receive, deadline))
    try:
        yield left
    finally:
        left.cancel()


async def _until_left(receive: Receive, deadline: Deadline) -> None:
    # If the call does not read its body, a too large body ends the listening, not the call.
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
        "The call waited too long for its turn: the service is too busy; try again shortly."
    )
