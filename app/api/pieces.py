"""An answer that is made in pieces, while it is sent.

Making a piece is heavy work and needs a slot at the gate. Whoever reads slowly holds none:
while a piece waits to be sent the slot is given back. A reader who takes less than LEAST_RATE
is cut off, since each open answer holds its motion in memory.
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
from app.errors import ClientLeft, KinedexError

log = logging.getLogger(__name__)

LEAST_RATE = 32 * 1024
"""Bytes a second that a reader must take, on average over the whole answer."""
GRACE_SECONDS = 20.0
"""How far a reader may fall behind that: a page that is in the background, a poor connection."""
PATIENCE_SECONDS = 0.02
"""How long a slot is held while a piece waits to be sent."""
TURN_SECONDS = 0.25
"""How long pieces are made before others that wait are let in first."""
MOST_BYTES = 256 * 1024
"""Sent at once: what is larger is cut, so that a slow reader is noticed."""


class Pieces(Response):
    """A streamed answer. It has failed as any other where the first piece fails."""

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
        """Raises TooBusy, DeadlineExceeded, ClientLeft before the first piece, CutOff behind it."""
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
                    deadline.restart()  # how long the client reads is not our time
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
        piece = await run_in_threadpool(next, self._pieces, None)
        return piece.encode() if isinstance(piece, str) else piece


class _Sending:
    """Sends parts, and gives the slot back where the client does not take them at once."""

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
        sending = asyncio.ensure_future(self._send(message))
        began = time.monotonic()
        try:
            await asyncio.wait({sending}, timeout=PATIENCE_SECONDS)
            if not sending.done():
                self._slot.give_back()
                left = GRACE_SECONDS + self._sent / LEAST_RATE - self._waited
                await asyncio.wait({sending}, timeout=max(left, 0.0))
            if not sending.done():
                raise ReaderTooSlow(
                    f"The client read less than {LEAST_RATE // 1024} KiB a second of the answer."
                )
            sending.result()
        finally:
            sending.cancel()
        self._waited += time.monotonic() - began


def _parts(piece: bytes) -> Iterator[bytes]:
    for first in range(0, len(piece), MOST_BYTES):
        yield piece[first : first + MOST_BYTES]
