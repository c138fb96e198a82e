"""Checks before the service listens: no other machine may reach it until an API key exists."""

from __future__ import annotations

import socket

from app.config import Settings
from app.errors import ConfigurationError, DatabaseOutOfDate
from app.kinedex_error import Place
from app.store import identity, keys
from app.store.store import Store

CANNOT_START = 78
"""Exit code of a process that cannot start because of its settings, its port or its database.
Another try would fail too (EX_CONFIG of sysexits.h)."""
START_FAILURES = (ConfigurationError, DatabaseOutOfDate)
"""Failures that end a process with the exit code CANNOT_START."""


def refuse_exposure_without_keys(settings: Settings) -> None:
    """Raise ConfigurationError if other machines could reach a service without an API key.

    Also raises DatabaseOutOfDate and LibraryMismatch, since the keys are in the database.
    """
    if settings.listens_on_loopback:
        return
    identity.prepare(settings.database, settings.files_place)
    store = Store.open(settings.database, settings.files_place)
    try:
        with store.read() as tx:
            is_guarded = keys.is_any_valid(tx)
    finally:
        store.close()
    if not is_guarded:
        raise ConfigurationError(
            f"Kinedex does not listen on {settings.host} without an API key: make one with "
            "`kinedex keys create --role admin`, or listen on 127.0.0.1.",
            places=[Place("KINEDEX_HOST", "other machines could read and change the library")],
        )


def refuse_taken_address(settings: Settings) -> None:
    """Raise ConfigurationError if the service cannot listen, before it starts any process."""
    bound(settings).close()


def bound(settings: Settings) -> socket.socket:
    """A socket at the address of the service, which does not listen yet.

    Raises ConfigurationError if the address cannot be used.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        trial = socket.socket(family, kind, protocol)
        try:
            # The server sets it too: old connections in TIME_WAIT do not block the port.
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(address)
        except OSError:
            trial.close()
            raise
        return trial
    except OSError as error:
        raise ConfigurationError(
            f"Kinedex cannot listen on {settings.host} port {settings.port}: {error.strerror}.",
            places=[Place("KINEDEX_PORT", "choose another, or stop the program that has it")],
        ) from error
