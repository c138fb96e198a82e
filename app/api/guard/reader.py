"""Watches whether a client reads its answer.

The bytes of an answer wait in the connection's buffer until the client reads them. A client that
reads nothing would hold its connection forever. So while bytes wait, we look at the buffer
regularly, and report when it has not become smaller for some time.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

LOOK_SECONDS = 2.0
"""Between two looks at the buffer."""
STALLED_SECONDS = 10.0
"""Time without progress after which the connection may be closed for another client."""
GONE_SECONDS = 60.0
"""Time without progress after which the connection is closed in any case."""


class Reader:
    """Watches the client of one connection.

    on_stall: called once when the client has read nothing for STALLED_SECONDS; on_resume: called
    once when it reads again; on_gone: called once after GONE_SECONDS.
    """

    def __init__(
        self,
        transport: asyncio.Transport,
        *,
        on_stall: Callable[[], None],
        on_resume: Callable[[], None],
        on_gone: Callable[[], None],
    ) -> None:
        self._transport = transport
        self._on_stall, self._on_resume, self._on_gone = on_stall, on_resume, on_gone
        self._timer: asyncio.TimerHandle | None = None
        self._left = 0
        self._moved_at = 0.0
        self._has_stalled = False

    @property
    def has_all(self) -> bool:
        """Whether the client has read everything."""
        return self._transport.get_write_buffer_size() == 0

    def watch(self) -> None:
        """Look at the buffer regularly until it is empty."""
        if self._timer is None and not self.has_all:
            self._left = self._transport.get_write_buffer_size()
            self._moved_at = time.monotonic()
            self._look_later()

    def moves(self) -> None:
        """Note that the client has read some of the waiting bytes."""
        self._moved_at = time.monotonic()
        if self._has_stalled:
            self._has_stalled = False
            self._on_resume()

    def stop(self) -> None:
        """Stop watching: the connection is closed."""
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
            self._on_gone()
            return
        if still >= STALLED_SECONDS and not self._has_stalled:
            self._has_stalled = True
            self._on_stall()
        self._look_later()
