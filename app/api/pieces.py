"""An answer that is computed and sent in pieces.

Computing a piece is heavy work and needs a slot at the gate. A slow reader holds no slot: while a
piece waits to be sent, the answer gives its slot back. An answer whose client reads less than
MIN_BYTES_PER_SECOND is cut off, because each open answer holds its motion in memory.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Iterable, Iterator, Mapping

from fastapi import Response
from fastapi.concurrency import run_in_threadpool
from starlette.types import Message, Receive, Scope, Send

from app.api.failures.problems import ReaderTooSlow, status_of
from app.api.guard.envelope import CutOff
from app.api.guard.gates import Gates, Slot, listening
from app.deadline import Deadline, within
from app.errors import ClientLeft
from app.kinedex_error import KinedexError

log = logging.getLogger(__name__)

MIN_BYTES_PER_SECOND = 32 * 1024
"""Bytes per second that a client must read, on average over the whole answer."""
GRACE_SECONDS = 20.0
"""How far a client may fall behind that rate: its page may be in the background, for example."""
PATIENCE_SECONDS = 0.02
"""How long an answer holds its slot while a piece waits to be sent."""
TURN_SECONDS = 0.25
"""How long an answer computes pieces before it lets a waiting call go first."""
MAX_PART_BYTES = 256 * 1024
"""Bytes sent at once. A larger piece is cut into parts, so that we notice a slow client."""


class Pieces(Response):
    """A streamed answer. If its first piece fails, the client gets an ordinary problem."""

    def __init__(
        self,
        content: Iterable[bytes | str],
        *,
        media_type: str,
        headers: Mapping[str, str] | None = None,
        status_code: int = 200,
    ) -> None:
        self._pieces: Iterator[bytes | str] = iter(content)
        self.status_code = status_code
        self.media_type = media_type
        self.background = None
        self.init_headers(headers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Raises TooBusy, DeadlineExceeded, ClientLeft before the first piece, CutOff after it."""
        gates: Gates = scope["app"].state.gates
        deadline = Deadline(gates.seconds)
        async with gates.streams.one(), listening(receive, deadline) as left:
            slot = Slot(gates.heavy, deadline, left)
            try:
                with within(deadline):
                    await self._answer(_Sending(send, slot), slot, deadline)
            finally:
                deadline.abandon()
                slot.give_back()

    async def _answer(self, sending: _Sending, slot: Slot, deadline: Deadline) -> None:
        await slot.take(again=True)
        piece = await self._next()
        try:
            await sending.start(self.status_code, self.raw_headers)
            turn_ends = time.monotonic() + TURN_SECONDS
            while piece is not None:
                for part in _parts(piece):
                    await sending.part(part)
                    deadline.restart()  # the time in which the client reads does not count
                    deadline.check()
                if time.monotonic() > turn_ends:
                    await slot.share()
                    turn_ends = time.monotonic() + TURN_SECONDS
                await slot.take(again=True)
                piece = await self._next()
            await sending.end()
        except KinedexError as failure:
            if not isinstance(failure, ClientLeft):
                log.warning("an answer was cut off: %s", failure.detail)
            raise CutOff(status_of(type(failure))) from failure

    async def _next(self) -> bytes | None:
        # In a thread: computing a piece would block the event loop.
        piece = await run_in_threadpool(next, self._pieces, None)
        return piece.encode() if isinstance(piece, str) else piece


class _Sending:
    """Sends parts, and gives the slot back if the client does not read them at once."""

    def __init__(self, send: Send, slot: Slot) -> None:
        self._send = send
        self._slot = slot
        self._sent = 0
        self._waited = 0.0

    async def start(self, status: int, headers: list[tuple[bytes, bytes]]) -> None:
        await self._message({"type": "http.response.start", "status": status, "headers": headers})

    async def part(self, part: bytes) -> None:
        await self._message({"type": "http.response.body", "body": part, "more_body": True})
        self._sent += len(part)

    async def end(self) -> None:
        await self._message({"type": "http.response.body", "body": b"", "more_body": False})

    async def _message(self, message: Message) -> None:
        """Raises ReaderTooSlow."""
        # A task, so that we can give the slot back while the message is still being sent.
        sending = asyncio.ensure_future(self._send(message))
        began = time.monotonic()
        try:
            await asyncio.wait({sending}, timeout=PATIENCE_SECONDS)
            if not sending.done():
                self._slot.give_back()
                left = GRACE_SECONDS + self._sent / MIN_BYTES_PER_SECOND - self._waited
                await asyncio.wait({sending}, timeout=max(left, 0.0))
            if not sending.done():
                raise ReaderTooSlow(
                    f"The client read the answer at less than {MIN_BYTES_PER_SECOND // 1024} KiB/s."
                )
            sending.result()
        finally:
            sending.cancel()
        self._waited += time.monotonic() - began


def _parts(piece: bytes) -> Iterator[bytes]:
    for first in range(0, len(piece), MAX_PART_BYTES):
        yield piece[first : first + MAX_PART_BYTES]
