"""How fast a request's body arrives, and when it counts as too slow.

Only the time in which we wait for the client counts. Three rules:

- a client may pause for PAUSE_SECONDS at most;
- its body must come with LEAST_RATE, and may fall behind that by GRACE_SECONDS;
- while others wait for a place, one that falls behind BRISK_RATE by FAIR_SECONDS may have to
  leave.

Nobody gets ahead of a rate: a client that has sent much in a moment must go on at that rate too.
Else it could hold its place for hours with what it sent at first.
"""

from __future__ import annotations

import asyncio
import time

from starlette.types import Message, Receive

PAUSE_SECONDS = 20.0
GRACE_SECONDS = 20.0
LEAST_RATE = 10_000.0
"""Bytes a second."""
FAIR_SECONDS = 2.0
BRISK_RATE = 100_000.0
"""Bytes a second."""


class TooSlow(Exception):
    """The body came too slowly, or had to make room."""


class Arrival:
    """One body on its way; `next` gives its next piece."""

    def __init__(self) -> None:
        # Seconds behind each rate.
        self._late = self._unfair = 0.0
        self._began: float | None = None
        self._limit: asyncio.Timeout | None = None
        self._is_over = False

    async def next(self, receive: Receive) -> Message:
        """The next piece of the body. Raises TooSlow."""
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
        """So many bytes have come."""
        self._late = max(0.0, self._late - count / LEAST_RATE)
        self._unfair = max(0.0, self._unfair - count / BRISK_RATE)

    def behind(self) -> float:
        """Seconds that it is behind BRISK_RATE now."""
        return self._unfair + self._waits()

    def is_slow(self) -> bool:
        """Whether it may be asked to leave for another body."""
        return self.behind() >= FAIR_SECONDS

    def give_up(self) -> None:
        """Make `next` raise TooSlow, now or when it is called."""
        self._is_over = True
        if self._limit is not None and not self._limit.expired():
            self._limit.reschedule(asyncio.get_running_loop().time())

    def _patience(self) -> float:
        return max(0.0, min(PAUSE_SECONDS, GRACE_SECONDS - self._late))

    def _waits(self) -> float:
        return 0.0 if self._began is None else time.monotonic() - self._began
