"""The command that analyzes stored clips again."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_library

if TYPE_CHECKING:
    from app.services.library.library import Library


def reanalyze(
    context: typer.Context,
    every: Annotated[
        bool,
        typer.Option(
            "--all", help="All ready clips, not only those that an earlier version analyzed."
        ),
    ] = False,
    failed: Annotated[bool, typer.Option("--failed", help="Also the failed clips.")] = False,
    wait: Annotated[
        bool, typer.Option(help="Analyze now; with --no-wait, a worker analyzes the clips later.")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Analyze clips again from their stored files.

    A worker does this when it starts, for clips that an earlier version analyzed. Ready clips stay
    ready, and searches find them, until the new analysis replaces the old one.
    """
    from app.cli.library import fit_if_due, working
    from app.services.clips import reanalysis

    with open_library(context) as lib:
        queued = reanalysis.requeue_outdated(lib)
        queued += reanalysis.requeue_ready(lib) if every else 0
        queued += reanalysis.requeue_failed(lib) if failed else 0
        if wait and _count_waiting(lib):
            with working(lib):
                _show_progress(lib)
                fit_if_due(lib)
        waiting = _count_waiting(lib)
    if as_json:
        print_json({"queued": queued, "waiting": waiting})
    else:
        typer.echo(f"{queued} clips queued, {waiting} waiting.")


def _show_progress(lib: Library) -> None:
    """Show how many clips are analyzed, until no clip waits."""
    from app.cli.library import POLL_S

    with progress_bar() as bar:
        total = _count_waiting(lib)
        task = bar.add_task("analyzing", total=total)
        while waiting := _count_waiting(lib):
            bar.update(task, completed=total - waiting)
            time.sleep(POLL_S)
        bar.update(task, completed=total)


def _count_waiting(lib: Library) -> int:
    from app.store.clips import listing as clip_listing

    with lib.store.read() as tx:
        return clip_listing.count_waiting(tx)
