"""How fast a request's body arrives, and when it counts as too slow.

Only the time in which we wait for the client counts. Three rules:

- a client may pause for PAUSE_SECONDS at most;
- its body must come with MIN_BYTES_PER_SECOND, and may fall behind that by GRACE_SECONDS;
- while others wait for a slot, a body that is FAIR_SECONDS behind FAIR_BYTES_PER_SECOND may lose
  its slot.

A client cannot get ahead of a rate: if it sends much in a moment, it must go on at that rate too.
Otherwise it could send much at first, and then hold its slot for hours.
"""

from __future__ import annotations

import asyncio
import time

from starlette.types import Message, Receive

PAUSE_SECONDS = 20.0
GRACE_SECONDS = 20.0
MIN_BYTES_PER_SECOND = 10_000.0
"""Bytes a second."""
FAIR_SECONDS = 2.0
FAIR_BYTES_PER_SECOND = 100_000.0
"""Bytes a second."""


class TooSlow(Exception):
    """The body came too slowly, or lost its slot to another body."""


class Arrival:
    """The arrival of one body. `next` returns the next piece of the body."""

    def __init__(self) -> None:
        # Seconds behind MIN_BYTES_PER_SECOND and behind FAIR_BYTES_PER_SECOND.
        self._late = self._unfair = 0.0
        self._began: float | None = None
        self._limit: asyncio.Timeout | None = None
        self._is_over = False

    async def next(self, receive: Receive) -> Message:
        """Return the next piece of the body. Raises TooSlow."""
        if self._is_over:
            raise TooSlow
        self._began = time.monotonic()
        try:
            async with asyncio.timeout(self._patience()) as self._limit:
                message = await receive()
        except TimeoutError:
            self._is_over = True
            raise TooSlow from None
        finally:
            waits = self._waits()
            self._late, self._unfair = self._late + waits, self._unfair + waits
            self._began, self._limit = None, None
        self.came(len(message.get("body", b"")))
        return message

    def came(self, count: int) -> None:
        """Count bytes that have come: they reduce the time behind each rate, but not below 0."""
        self._late = max(0.0, self._late - count / MIN_BYTES_PER_SECOND)
        self._unfair = max(0.0, self._unfair - count / FAIR_BYTES_PER_SECOND)

    def behind(self) -> float:
        """Return the seconds that the body is behind FAIR_BYTES_PER_SECOND now."""
        return self._unfair + self._waits()

    def is_slow(self) -> bool:
        """Whether the body may lose its slot to another body."""
        return self.behind() >= FAIR_SECONDS

    def give_up(self) -> None:
        """Take the slot away: `next` raises TooSlow, now or at its next call."""
        self._is_over = True
        if self._limit is not None and not self._limit.expired():
            self._limit.reschedule(asyncio.get_running_loop().time())

    def _patience(self) -> float:
        return max(0.0, min(PAUSE_SECONDS, GRACE_SECONDS - self._late))

    def _waits(self) -> float:
        return 0.0 if self._began is None else time.monotonic() - self._began
