"""HTTP/1.1 with limits for clients that are slow, or do not send HTTP.

uvicorn limits the size of a request's headers. It does not limit the time in which they arrive,
the number of connections, or the time in which a client reads an answer. This module adds these
three limits. It answers a broken request with a problem (RFC 9457).
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
"""Time for the headers of a request, from the start of the connection or the first byte."""
LINGER_SECONDS = 5.0
"""Time in which a client can read the end of an answer after we closed the connection."""


class GuardedProtocol(H11Protocol):
    """uvicorn's protocol with a time limit for headers. `connections` counts each instance."""

    def __init__(self, *args: Any, connections: Connections, **named: Any) -> None:
        super().__init__(*args, **named)
        self._counted = connections
        self._header_timer: asyncio.TimerHandle | None = None
        self._waits = True
        self._has_begun = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Count the connection and wait for its first request, or refuse the connection."""
        super().connection_made(transport)
        self._reader = Reader(
            transport, on_stall=self._stalls, on_resume=self._resumes, on_gone=self.give_up
        )
        address = self.client[0] if self.client else ""
        if not self._counted.enter(self, address):
            self._answer(problem_of(TooManyConnections()), {"Retry-After": RETRY_AFTER_SECONDS})
            return
        self._time_headers()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop counting the connection."""
        self._counted.leave(self)
        self._stop_timer()
        self._reader.stop()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        """The client reads slower than we send: watch whether it reads anything."""
        super().pause_writing()
        self._reader.watch()

    def resume_writing(self) -> None:
        """The client has read most of the waiting bytes."""
        self._reader.moves()
        super().resume_writing()

    def data_received(self, data: bytes) -> None:
        """Start the time for the headers at the first byte of a request."""
        self._has_begun = True
        if self._waits and self._header_timer is None:
            self._time_headers()
        super().data_received(data)

    def handle_events(self) -> None:
        """Stop the time for the headers when they are complete."""
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
        """Close an idle connection. It is not idle while the client still reads an answer."""
        if self._reader.has_all:
            super().timeout_keep_alive_handler()
            self._close()
        else:
            self.timeout_keep_alive_task = self.loop.call_later(
                self.timeout_keep_alive, self.timeout_keep_alive_handler
            )

    def give_up(self) -> None:
        """Close at once: the client is gone, or another client needs the connection."""
        self.transport.abort()

    def send_400_response(self, msg: str) -> None:
        """Answer bytes that are not HTTP. Nothing more is read from this client."""
        # A call that is being answered sees that its client has left.
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

    def _answer(self, members: dict[str, Any], headers: dict[str, str] | None = None) -> None:
        """Send a problem and close. If an answer has begun already, only close."""
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            answer = respond(
                members, {**SECURITY_HEADERS, "Connection": "close", **(headers or {})}
            )
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
