"""The command that checks the library for damage."""

from __future__ import annotations

from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import typer

from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_store

if TYPE_CHECKING:
    from app.store.upkeep.verify import VerificationReport

FAILURE = 1


def verify(context: typer.Context, as_json: AsJson = False) -> None:
    """Read the whole library and say what is damaged or missing; the exit code is then 1.

    The database's pages and references, every stored file against its SHA-256, every array. It may
    run while the library is in use.
    """
    from app.store.upkeep.verify import verify as look

    with open_store(context) as store, progress_bar() as bar:
        task = bar.add_task("reading", total=None)
        found = look(store, lambda done, total: bar.update(task, completed=done, total=total))
        bar.update(task, completed=1, total=1)
    if as_json:
        print_json({"is_whole": found.is_whole, **asdict(found)})
    else:
        _show(found)
    if not found.is_whole:
        raise typer.Exit(FAILURE)


def _show(found: VerificationReport) -> None:
    typer.echo(f"{found.files} files and {found.arrays} arrays were read.")
    for noun, names in (
        ("damage of the database", found.damage),
        ("array that cannot be read", found.unreadable),
        ("missing file", found.missing),
        ("damaged file", found.damaged),
    ):
        for name in names:
            typer.echo(f"  {noun}: {name}")
    if found.unknown:
        typer.echo(
            f"{len(found.unknown)} files that the database does not name; the next sweep "
            "moves them to the quarantine."
        )
    if found.quarantine.oldest is not None:
        since = datetime.fromtimestamp(found.quarantine.oldest, UTC)
        typer.echo(
            f"The quarantine holds {len(found.quarantine.names)} files, "
            f"{found.quarantine.bytes} bytes, the oldest since {since:%Y-%m-%d %H:%M} UTC."
        )
    typer.echo("The library is whole." if found.is_whole else "The library is not whole.")
