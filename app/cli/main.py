"""The program: its commands, and its messages for failures."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from app import __version__
from app.cli.commands import COMMANDS, NEEDS_THIS_MACHINE
from app.cli.lazy import lazy_group
from app.cli.settings import remember, remote_of
from app.errors import ClipNotFound, ConfigurationError, Unauthorized
from app.kinedex_error import KinedexError

FAILURE = 1
PARTS_OF_REQUESTS = frozenset({"body", "query", "path", "header"})
"""The first part of a location in a problem of the API. It means nothing to a user of commands."""

KEY_ADVICE = "Give a key with --api-key or KINEDEX_API_KEY; `kinedex keys create` makes one."
OPTIONS_OF_ALL = frozenset({"--data-dir", "--database-url", "--url", "--api-key"})

program = typer.Typer(
    cls=lazy_group(COMMANDS),
    name="kinedex",
    help="A self-hosted search engine for human motion.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich would take "[x, y, z]" in a help text for markup, and remove it
)


def _show_version(is_requested: bool) -> None:
    if is_requested:
        typer.echo(f"kinedex {__version__}")
        raise typer.Exit


@program.callback()
def settings(
    context: typer.Context,
    data_dir: Annotated[
        Path | None, typer.Option(help="Directory of the database and files [KINEDEX_DATA_DIR].")
    ] = None,
    database_url: Annotated[
        str | None, typer.Option(help="Database [KINEDEX_DATABASE_URL].")
    ] = None,
    url: Annotated[
        str | None,
        typer.Option(help="Address of a service to use instead of a local library [KINEDEX_URL]."),
    ] = None,
    api_key: Annotated[
        str | None, typer.Option(help="API key for that service [KINEDEX_API_KEY].")
    ] = None,
    _version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of all commands, before or after the command; other settings are KINEDEX_*."""
    remember(context, data_dir=data_dir, database_url=database_url, url=url, api_key=api_key)
    if context.invoked_subcommand in NEEDS_THIS_MACHINE and remote_of(context) is not None:
        raise ConfigurationError(
            f"`kinedex {context.invoked_subcommand}` works on the library of this machine, so it "
            "cannot be used with --url or KINEDEX_URL. Run it on the machine of the service."
        )


def options_first(words: Sequence[str]) -> list[str]:
    """The words of a command line with the options of all commands moved before the command.

    So they can be written after the command too. Words after `--` stay where they are.
    """
    end = words.index("--") if "--" in words else len(words)
    first: list[str] = []
    rest: list[str] = []
    left = list(words[:end])
    while left:
        word = left.pop(0)
        if word in OPTIONS_OF_ALL and left:
            first += [word, left.pop(0)]
        else:
            is_option = word.partition("=")[0] in OPTIONS_OF_ALL and "=" in word
            (first if is_option else rest).append(word)
    return [*first, *rest, *words[end:]]


def main() -> None:
    """Run the command line. A failure prints its message and ends the program with status 1."""
    try:
        program(options_first(sys.argv[1:]))
    except Exception as failure:
        lines = _message(failure)
        if lines is None:
            raise
        typer.echo(f"kinedex: {lines[0]}", err=True)
        for line in lines[1:]:
            typer.echo(f"  {line}", err=True)
        sys.exit(FAILURE)


def _message(failure: Exception) -> list[str] | None:
    """The lines that describe a failure that a user can fix; None for a defect of Kinedex."""
    if getattr(failure, "code", None) == ClipNotFound.code:
        return [str(failure)]  # it names the clip
    if isinstance(failure, KinedexError):
        return [failure.detail, *_other_places(failure.detail, failure.places)]
    client = sys.modules.get("kinedex")  # it is imported only by commands that use it
    if client is not None and isinstance(failure, client.KinedexError):
        if failure.code == Unauthorized.code:
            return [failure.detail, KEY_ADVICE]
        return [failure.detail, *_other_places(failure.detail, failure.errors)]
    if isinstance(failure, OSError):
        # a user can fix these (permissions, a full disk), so no traceback is shown
        return [_os_message(failure)]
    return None


def _other_places(detail: str, places: Any) -> list[str]:
    """A line for each place of a failure whose message the detail does not end with already."""
    said = detail.rstrip(".")
    others = [place for place in places if not said.endswith(place.message.rstrip("."))]
    return [f"{_location(place.location)}{place.message}" for place in others]


def _location(location: str) -> str:
    part, _, rest = location.partition(".")
    name = rest if part in PARTS_OF_REQUESTS else location
    return f"{name}: " if name else ""


def _os_message(failure: OSError) -> str:
    """The message without the error number, which means nothing to a user."""
    if failure.strerror is None or failure.filename is None:
        return str(failure)
    return f"{failure.filename}: {failure.strerror}"
