"""How fast a request's body arrives, and when it counts as too slow.

Only the time in which we wait for the client counts. Three rules:

- a client may pause for PAUSE_SECONDS at most;
- after GRACE_SECONDS, its body must have come with LEAST_RATE on average;
- while others wait for a place, one below BRISK_RATE may have to leave after FAIR_SECONDS.
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
    """One body on its way; `receive` gives its next piece."""

    def __init__(self) -> None:
        self.received = 0
        self._waited = 0.0
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
            self._waited, self._began, self._limit = self._seconds(), None, None
        self.received += len(message.get("body", b""))
        return message

    def rate(self) -> float:
        """Bytes for each second of waiting so far."""
        return self.received / max(self._seconds(), 1e-9)

    def is_slow(self) -> bool:
        """Whether it may be asked to leave for another body."""
        return self._seconds() >= FAIR_SECONDS and self.rate() < BRISK_RATE

    def give_up(self) -> None:
        """Make `next` raise TooSlow, now or when it is called."""
        self._is_over = True
        if self._limit is not None:
            self._limit.reschedule(asyncio.get_running_loop().time())

    def _patience(self) -> float:
        allowed = GRACE_SECONDS + self.received / LEAST_RATE
        return max(0.0, min(PAUSE_SECONDS, allowed - self._waited))

    def _seconds(self) -> float:
        return self._waited + (0.0 if self._began is None else time.monotonic() - self._began)
