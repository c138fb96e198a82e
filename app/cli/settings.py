"""The settings of a command: its flags, then the environment, then the settings file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from app.errors import ConfigurationError

if TYPE_CHECKING:
    from app.config import Settings
    from app.services.library.library import Library
    from app.store.store import Store


def remember(context: typer.Context, **flags: Any) -> None:
    """Store the options of the program (before the command) for the command."""
    context.obj = flags


def settings_of(context: typer.Context, **flags: Any) -> Settings:
    """The active settings; flags that are None are ignored. Raises ConfigurationError."""
    from app.config import load_settings

    return load_settings(**{**(context.obj or {}), **flags})


@contextmanager
def open_store(context: typer.Context, *, for_copy: bool = False) -> Iterator[Store]:
    """Open the store of an existing library, and close it at the end. Nothing is created.

    for_copy: the database may have the schema of an earlier version. Raises ConfigurationError,
    LibraryMismatch, DatabaseOutOfDate, StorageError.
    """
    from app.store import identity
    from app.store.store import Store

    settings = settings_of(context)
    if not identity.is_database_there(settings.database):
        raise ConfigurationError(f"There is no library in {settings.data_dir}.")
    check = identity.check_copyable if for_copy else identity.check
    library_id = check(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir, library_id)
    try:
        yield store
    finally:
        store.close()


@contextmanager
def open_library(context: typer.Context) -> Iterator[Library]:
    """Open the library of the settings, and close it at the end. Raises ConfigurationError."""
    from app.services.library.library import Library

    library = Library.open(settings_of(context))
    try:
        yield library
    finally:
        library.close()
