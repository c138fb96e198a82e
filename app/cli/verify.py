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
"""The exit code for a damaged library."""


def verify(context: typer.Context, as_json: AsJson = False) -> None:
    """Check the whole library for damaged or missing data; the exit code is then 1.

    This reads the pages and references of the database, every array, and every stored file, which
    it compares with its SHA-256. You can run it while the library is in use.
    `kinedex doctor --mend` mends what it finds.
    """
    from app.services.mending import examine

    with open_store(context) as store, progress_bar() as bar:
        task = bar.add_task("reading", total=None)
        report = examine(store, lambda done, total: bar.update(task, completed=done, total=total))
        bar.update(task, completed=1, total=1)
    if as_json:
        print_json({"is_whole": report.is_whole, **asdict(report)})
    else:
        _print_report(report)
    if not report.is_whole:
        raise typer.Exit(FAILURE)


def _print_report(report: VerificationReport) -> None:
    typer.echo(f"{report.files} files and {report.arrays} arrays were read.")
    for noun, names in (
        ("damage of the database", report.damage),
        ("array that cannot be read", report.unreadable),
        ("missing array", report.lacking),
        ("missing file", report.missing),
        ("damaged file", report.damaged),
    ):
        for name in names:
            typer.echo(f"  {noun}: {name}")
    if report.unknown:
        typer.echo(
            f"The database does not name {len(report.unknown)} files; the next sweep moves them "
            "to the quarantine."
        )
    if report.quarantine.oldest is not None:
        since = datetime.fromtimestamp(report.quarantine.oldest, UTC)
        typer.echo(
            f"The quarantine holds {len(report.quarantine.names)} files, "
            f"{report.quarantine.bytes} bytes, the oldest since {since:%Y-%m-%d %H:%M} UTC."
        )
    typer.echo(
        "The library is complete and undamaged." if report.is_whole else "The library is damaged."
    )
