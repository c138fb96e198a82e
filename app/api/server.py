"""The API process: uvicorn runs the application. `python -m app.api.server` starts only this.

With `--fd N` it listens on an inherited socket, which it shares with other processes of the API
(`app.worker.api_processes`). It takes one connection at a time, so that a process that works leaves
the next one to a process that does not.
"""

from __future__ import annotations

import logging
import socket
import sys
from collections.abc import Sequence
from functools import partial
from types import FrameType
from typing import cast

import uvicorn
from fastapi import FastAPI

from app.api.app import create_app
from app.api.guard.connections import Connections, room_for_connections
from app.api.guard.protocol import GuardedProtocol
from app.config import Settings, load_settings
from app.json_stderr import json_stderr
from app.logs import set_level
from app.services.exposure import CANNOT_START, START_FAILURES, refuse_taken_address

log = logging.getLogger(__name__)

GRACE_SECONDS = 5
"""How long running requests may go on after a stop. Then they are cut off."""
FD = "--fd"
BACKLOG = 256
"""Connections that the kernel queues until uvicorn accepts them."""


class _Server(uvicorn.Server):
    """A uvicorn server that ends the application's streams first, so that it stops soon."""

    def __init__(self, config: uvicorn.Config, app: FastAPI) -> None:
        super().__init__(config)
        self._app = app

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """On SIGINT or SIGTERM."""
        self._app.state.stopping = True
        super().handle_exit(sig, frame)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen."""
        await super().startup(sockets)
        for one in sockets or ():
            # asyncio takes as many connections at once as it lets the kernel queue.
            one.listen(BACKLOG)


def run(settings: Settings, shared: socket.socket | None = None) -> None:
    """Serve until SIGINT or SIGTERM. Raises the KinedexError of a library that cannot be opened.

    shared: a socket on which other processes listen too; None to listen alone.
    """
    set_level(settings.log_level.upper())
    app = create_app(settings)
    limit = room_for_connections(settings.max_connections, BACKLOG)
    connections = Connections(limit, settings.max_connections_per_address)
    protocol = partial(GuardedProtocol, connections=connections)
    config = uvicorn.Config(
        app,
        # uvicorn only calls this value, so a partial works like the class.
        http=cast(type[GuardedProtocol], protocol),
        # We have no websockets, and uvicorn's protocol for them has none of our limits.
        ws="none",
        backlog=BACKLOG if shared is None else 1,
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        root_path=settings.root_path,
        # uvicorn's own default believes every program of this machine.
        proxy_headers=bool(settings.trusted_proxies),
        forwarded_allow_ips=list(settings.trusted_proxies),
        timeout_graceful_shutdown=GRACE_SECONDS,
    )
    try:
        _Server(config, app).run(None if shared is None else [shared])
    except SystemExit:
        # uvicorn exits with a code only. The failure itself is what the caller needs.
        if app.state.start_failure is not None:
            raise app.state.start_failure from None
        raise


def main(arguments: Sequence[str]) -> int:
    """Serve until a stop signal and return 0. arguments: none, or `--fd` and a number.

    Returns CANNOT_START if the settings, the port or the database do not allow a start.
    """
    with json_stderr():
        try:
            settings = load_settings()
            if arguments[:1] == [FD]:
                run(settings, socket.socket(fileno=int(arguments[1])))
            else:
                refuse_taken_address(settings)
                run(settings)
        except START_FAILURES as problem:
            log.critical("the API cannot start: %s", problem.detail)
            return CANNOT_START
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
