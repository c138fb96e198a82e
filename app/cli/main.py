"""The program: its commands, and its messages for failures."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from app import __version__
from app.cli.commands import COMMANDS
from app.cli.lazy import lazy_group
from app.cli.settings import remember
from app.errors import ClipNotFound, KinedexError

FAILURE = 1

program = typer.Typer(
    cls=lazy_group(COMMANDS),
    name="kinedex",
    help="A self-hosted search engine for human motion.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
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
    _version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of all commands. They go before the command; other settings are KINEDEX_*."""
    remember(context, data_dir=data_dir, database_url=database_url)


def main() -> None:
    """Run the command line. A failure prints its message and ends the program with status 1."""
    try:
        program()
    except KinedexError as failure:
        typer.echo(f"kinedex: {failure.detail}", err=True)
        for line in _other_places(failure):
            typer.echo(f"  {line}", err=True)
        sys.exit(FAILURE)
    except OSError as failure:
        # a user can fix these (permissions, a full disk), so no traceback is shown
        typer.echo(f"kinedex: {_os_message(failure)}", err=True)
        sys.exit(FAILURE)


def _other_places(failure: KinedexError) -> list[str]:
    """A line for each place of a failure that its detail does not contain already."""
    if isinstance(failure, ClipNotFound):
        return []  # the detail names the clip
    lines = [f"{place.location}: {place.message}" for place in failure.places]
    return [line for line in lines if line not in failure.detail]


def _os_message(failure: OSError) -> str:
    """The message without the error number, which means nothing to a user."""
    if failure.strerror is None or failure.filename is None:
        return str(failure)
    return f"{failure.filename}: {failure.strerror}"
