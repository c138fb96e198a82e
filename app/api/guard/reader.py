"""Whether a client takes what is sent to it.

What an answer holds waits in the connection's buffer until the client has room for it. A client
that takes nothing would hold its connection for good. So while anything waits, we look at the
buffer again and again, and tell when it has not moved for some time.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

LOOK_SECONDS = 2.0
STALLED_SECONDS = 10.0
"""Without progress, after which the connection may be given up for another client."""
GONE_SECONDS = 60.0
"""Without progress, after which the connection is given up in any case."""


class Reader:
    """The client of one connection, as it reads.

    stalls: called at every look while it has stalled; resumes: once, when it goes on; is_gone:
    called once.
    """

    def __init__(
        self,
        transport: asyncio.Transport,
        *,
        stalls: Callable[[], None],
        resumes: Callable[[], None],
        is_gone: Callable[[], None],
    ) -> None:
        self._transport = transport
        self._stalls, self._resumes, self._is_gone = stalls, resumes, is_gone
        self._timer: asyncio.TimerHandle | None = None
        self._left = 0
        self._moved_at = 0.0
        self._has_stalled = False

    @property
    def has_all(self) -> bool:
        """Whether nothing waits to be taken."""
        return self._transport.get_write_buffer_size() == 0

    def watch(self) -> None:
        """Look at the buffer from now on, until it is empty."""
        if self._timer is None and not self.has_all:
            self._left = self._transport.get_write_buffer_size()
            self._moved_at = time.monotonic()
            self._look_later()

    def moves(self) -> None:
        """The client has taken much of what waited."""
        self._moved_at = time.monotonic()
        if self._has_stalled:
            self._has_stalled = False
            self._resumes()

    def stop(self) -> None:
        """The connection is closed."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _look_later(self) -> None:
        self._timer = asyncio.get_running_loop().call_later(LOOK_SECONDS, self._look)

    def _look(self) -> None:
        self._timer = None
        left = self._transport.get_write_buffer_size()
        if left < self._left:
            self.moves()
        self._left = left
        still = time.monotonic() - self._moved_at
        if not left:
            return
        if still >= GONE_SECONDS:
            self._is_gone()
            return
        if still >= STALLED_SECONDS and not self._has_stalled:
            self._has_stalled = True
            self._stalls()
        self._look_later()
