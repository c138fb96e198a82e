"""HTTP/1.1 on a connection whose client may be slow, or send what is no HTTP.

uvicorn bounds the size of a request's headers, but not the time that they take, nor the number
of connections, nor the time in which an answer is read. This adds all three, and answers what is
wrong with a problem (RFC 9457).
"""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from app.api.failures.problems import (
    RETRY_AFTER_SECONDS,
    RequestTimeout,
    TooManyConnections,
    problem,
    problem_of,
)
from app.api.failures.response import respond
from app.api.guard.connections import Connections
from app.api.guard.envelope import SECURITY_HEADERS
from app.api.guard.reader import Reader

HEADER_SECONDS = 10.0
"""For a request's headers to arrive, from the connection's start or the request's first byte."""
LINGER_SECONDS = 5.0
"""For the last bytes of an answer to be taken, after the connection was closed on our side."""


class GuardedProtocol(H11Protocol):
    """uvicorn's protocol with a time limit for headers, and counted among `connections`."""

    def __init__(self, *args: Any, connections: Connections, **named: Any) -> None:
        super().__init__(*args, **named)
        self._counted = connections
        self._header_timer: asyncio.TimerHandle | None = None
        self._waits = True
        self._has_begun = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Count the connection and wait for its first request, or refuse it."""
        super().connection_made(transport)
        self._reader = Reader(
            transport, stalls=self._stalls, resumes=self._resumes, is_gone=self.give_up
        )
        address = self.client[0] if self.client else ""
        if not self._counted.enter(self, address):
            self._answer(problem_of(TooManyConnections()), {"Retry-After": RETRY_AFTER_SECONDS})
            return
        self._time_headers()

    def connection_lost(self, exc: Exception | None) -> None:
        """Count the connection no more."""
        self._counted.leave(self)
        self._stop_timer()
        self._reader.stop()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        """More waits than the client takes: see whether it takes anything."""
        super().pause_writing()
        self._reader.watch()

    def resume_writing(self) -> None:
        """The client has taken most of what waited."""
        self._reader.moves()
        super().resume_writing()

    def data_received(self, data: bytes) -> None:
        """The first byte of a request starts the time for its headers."""
        self._has_begun = True
        if self._waits and self._header_timer is None:
            self._time_headers()
        super().data_received(data)

    def handle_events(self) -> None:
        """Headers that are complete stop the time."""
        super().handle_events()
        if self._waits and self.cycle is not None and not self.cycle.response_complete:
            self._waits = False
            self._stop_timer()
            self._counted.works(self)

    def on_response_complete(self) -> None:
        """Wait for the next request, which may have arrived already."""
        self._waits, self._has_begun = True, False
        self._counted.waits(self)
        self._reader.watch()
        super().on_response_complete()

    def timeout_keep_alive_handler(self) -> None:
        """Close an idle connection; one whose client still reads is not idle."""
        if self._reader.has_all:
            super().timeout_keep_alive_handler()
            self._close()
        else:
            self.timeout_keep_alive_task = self.loop.call_later(
                self.timeout_keep_alive, self.timeout_keep_alive_handler
            )

    def give_up(self) -> None:
        """Close at once: another client needs the place."""
        self.transport.abort()

    def send_400_response(self, msg: str) -> None:
        """Answer what is no HTTP; nothing more is read from this client."""
        if self.cycle is not None and not self.cycle.response_complete:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        self._answer(problem(400, "bad_request", msg))

    def _stalls(self) -> None:
        self._counted.waits(self)

    def _resumes(self) -> None:
        if not self._waits:
            self._counted.works(self)

    def _time_headers(self) -> None:
        self._header_timer = self.loop.call_later(HEADER_SECONDS, self._headers_are_late)

    def _stop_timer(self) -> None:
        if self._header_timer is not None:
            self._header_timer.cancel()
            self._header_timer = None

    def _headers_are_late(self) -> None:
        if self._has_begun:
            self._answer(problem_of(RequestTimeout("The request's headers came too slowly.")))
        else:
            self._close()

    def _answer(self, told: dict[str, Any], headers: dict[str, str] | None = None) -> None:
        """Send a problem and close; only close where an answer has begun already."""
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            answer = respond(told, {**SECURITY_HEADERS, "Connection": "close", **(headers or {})})
            start = h11.Response(
                status_code=answer.status_code,
                reason=HTTPStatus(answer.status_code).phrase.encode(),
                headers=[*self.server_state.default_headers, *answer.raw_headers],
            )
            events = (start, h11.Data(data=bytes(answer.body)), h11.EndOfMessage())
            self.transport.write(b"".join(self.conn.send(event) or b"" for event in events))
        self._close()

    def _close(self) -> None:
        self.transport.close()
        self.loop.call_later(LINGER_SECONDS, self.transport.abort)
