"""The kind of each call, named at its route: `dependencies=[reads, heavy]`.

It decides which gate (`app.api.guard.gates`) the call passes before its thread starts. It comes
last among a route's dependencies: a key is checked, and a body received, before a slot is
taken. The slot is given back before the answer is sent, so that nobody who reads slowly holds
one; answers in pieces take it again (`app.api.pieces`).

heavy: may compute for over 50 ms on a long clip (measured on one of ten minutes at 120 Hz).
quick: reads a few rows. changes: writes, or keeps what was uploaded. follow: is answered for
as long as a job lasts. at_once: takes no thread, or one that is kept for it.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from enum import StrEnum
from typing import TypeVar

import anyio
from fastapi import Depends, Request

from app.api.guard.gates import Gates

_Found = TypeVar("_Found")


class Kind(StrEnum):
    """What a call does to the service."""

    HEAVY = "heavy"
    QUICK = "quick"
    CHANGES = "changes"
    FOLLOW = "follow"
    AT_ONCE = "at_once"


class Admission:
    """A dependency: the call is of this kind, and let in as such."""

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
    """A few threads that no other call can take."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._limiter: anyio.CapacityLimiter | None = None

    async def run(self, work: Callable[[], _Found]) -> _Found:
        """What `work` returns, from one of them."""
        if self._limiter is None:  # it belongs to the event loop, which runs only now
            self._limiter = anyio.CapacityLimiter(self._count)
        return await anyio.to_thread.run_sync(work, limiter=self._limiter)
