"""The settings that a command runs with: its flags over the environment over the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from app.config import Settings
    from app.services.library import Library


def remember(context: typer.Context, **flags: Any) -> None:
    """Keep the program's own flags for the command that follows."""
    context.obj = flags


def settings_of(context: typer.Context, **flags: Any) -> Settings:
    """The settings in force; a flag of None counts as not given. Raises ConfigurationError."""
    from app.config import load_settings

    return load_settings(**{**(context.obj or {}), **flags})


@contextmanager
def open_library(context: typer.Context) -> Iterator[Library]:
    """The library of the settings, closed at the end."""
    from app.services.library import Library

    library = Library.open(settings_of(context))
    try:
        yield library
    finally:
        library.close()
