"""The kind of each call. A route names it: `dependencies=[reads, heavy]`.

The kind decides at which gate (`app.api.guard.gates`) the call waits before its thread starts.
It is the last dependency of a route: the key is checked and the body is received before the call
takes a slot. The call gives the slot back before its answer is sent, so that slow clients hold no
slots. Answers in pieces take a slot again (`app.api.pieces`).

heavy: may compute for over 50 ms on a long clip (measured on a clip of ten minutes at 120 Hz).
quick: reads a few rows. changes: writes to the store. follow: sends events until a job ends.
at_once: needs no thread, or has its own threads.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from enum import StrEnum
from typing import TypeVar

import anyio
from fastapi import Depends, Request

from app.api.guard.gates import Gates

_Result = TypeVar("_Result")


class Kind(StrEnum):
    """How much of the service a call uses, and for how long."""

    HEAVY = "heavy"
    QUICK = "quick"
    CHANGES = "changes"
    FOLLOW = "follow"
    AT_ONCE = "at_once"


class Admission:
    """A dependency: it holds a slot of the gate for calls of this kind."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind

    async def __call__(self, request: Request) -> AsyncIterator[None]:
        """Raises TooBusy, DeadlineExceeded, ClientLeft."""
        gates: Gates = request.app.state.gates
        if self.kind is Kind.AT_ONCE:
            yield
        elif self.kind is Kind.FOLLOW:
            async with gates.followers.one():
                yield
        else:
            gate = {Kind.HEAVY: gates.heavy, Kind.QUICK: gates.quick, Kind.CHANGES: gates.changes}
            async with gate[self.kind].admitted(request.receive, gates.seconds):
                yield


heavy = Depends(Admission(Kind.HEAVY), scope="function")
quick = Depends(Admission(Kind.QUICK), scope="function")
changes = Depends(Admission(Kind.CHANGES), scope="function")
follow = Depends(Admission(Kind.FOLLOW), scope="request")
at_once = Depends(Admission(Kind.AT_ONCE), scope="function")


class OwnThreads:
    """A few threads that no other call can use."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._limiter: anyio.CapacityLimiter | None = None

    async def run(self, work: Callable[[], _Result]) -> _Result:
        """Run `work` in one of the threads and return its result."""
        if self._limiter is None:  # a limiter needs the event loop, which runs only now
            self._limiter = anyio.CapacityLimiter(self._count)
        return await anyio.to_thread.run_sync(work, limiter=self._limiter)
