"""The settings of a command: its flags, then the environment, then the settings file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import typer

from app.errors import ConfigurationError

if TYPE_CHECKING:
    from app.config import Settings
    from app.services.library.library import Library
    from app.store.store import Store

MAKES_DATA_DIRECTORY = frozenset({"serve", "import", "demo"})
"""Commands that make the data directory if it does not exist."""
MAKES_LIBRARY = MAKES_DATA_DIRECTORY | {"worker", "create", "upgrade"}
"""Commands that make a library in an existing data directory: also `keys create`, because a service
for other machines needs a key before it starts, `db upgrade`, and `worker`."""
URL_ENV, KEY_ENV = "KINEDEX_URL", "KINEDEX_API_KEY"


@dataclass(frozen=True, slots=True)
class Remote:
    """A service on another machine (or port) that a command calls."""

    url: str
    api_key: str | None


def remember(context: typer.Context, **flags: Any) -> None:
    """Store options for the command. An option after the command replaces one before it."""
    root = context.find_root()
    given = {name: value for name, value in flags.items() if value is not None}
    root.obj = (root.obj or {}) | given


def flags_of(context: typer.Context) -> dict[str, Any]:
    """The stored options, by name."""
    return context.find_root().obj or {}


def remote_of(context: typer.Context) -> Remote | None:
    """The service that --url or KINEDEX_URL names, or None: then the local library is used."""
    flags = flags_of(context)
    url = flags.get("url") or os.environ.get(URL_ENV)
    key = flags.get("api_key") or os.environ.get(KEY_ENV)
    return Remote(url, key) if url else None


def settings_of(context: typer.Context, **flags: Any) -> Settings:
    """The active settings; flags that are None are ignored. Raises ConfigurationError."""
    from app.config import load_settings

    known = {k: v for k, v in flags_of(context).items() if k not in {"url", "api_key"}}
    return load_settings(**{**known, **flags})


@contextmanager
def open_store(context: typer.Context, *, for_copy: bool = False) -> Iterator[Store]:
    """Open the store of an existing library, and close it at the end. Nothing is created.

    for_copy: the database may have the schema of an earlier version. Raises ConfigurationError,
    LibraryMismatch, DatabaseOutOfDate, StorageError.
    """
    from app.store import identity
    from app.store.store import Store

    settings = settings_of(context)
    refuse_missing_library(settings)
    check = identity.check_copyable if for_copy else identity.check
    library_id = check(settings.database, settings.files_place)
    store = Store.open(settings.database, settings.files_place, library_id)
    try:
        yield store
    finally:
        store.close()


@contextmanager
def open_library(context: typer.Context) -> Iterator[Library]:
    """Open the library of the settings, and close it at the end.

    What the command changes is recorded in the audit log, once. Only the commands of MAKES_LIBRARY
    make a library. Raises ConfigurationError.
    """
    from app.services.library.library import Library
    from app.store import audit

    settings = settings_of(context)
    refuse_missing_library(settings, context.info_name or "")
    library = Library.open(settings)
    try:
        with audit.calling(audit.Call(_command_of(context))):
            yield library
    finally:
        library.close()


def _command_of(context: typer.Context) -> str:
    """The command without its arguments, for example `kinedex keys create`."""
    return " ".join(["kinedex", *context.command_path.split()[1:]])


def refuse_missing_library(settings: Settings, command: str = "") -> None:
    """Raises ConfigurationError if there is no library and the command does not make one.

    So a typing error in the name of the data directory does not make a new library.
    """
    from app.store import identity

    if not settings.data_dir.exists() and command not in MAKES_DATA_DIRECTORY:
        raise ConfigurationError(
            f"There is no library in {settings.data_dir}: the folder does not exist. Correct "
            "--data-dir or KINEDEX_DATA_DIR; `kinedex serve`, `import` and `demo` make a library."
        )
    if command not in MAKES_LIBRARY and not identity.is_database_there(settings.database):
        identity.refuse_files_without_database(settings.database, settings.files_place)
        raise ConfigurationError(f"There is no library in {settings.data_dir}.")
