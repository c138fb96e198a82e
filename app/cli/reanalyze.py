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
        bool, typer.Option("--all", help="All ready clips, not only those of an earlier version.")
    ] = False,
    failed: Annotated[bool, typer.Option("--failed", help="Failed clips too.")] = False,
    wait: Annotated[
        bool, typer.Option(help="Analyze now; --no-wait leaves that to the worker.")
    ] = True,
    as_json: AsJson = False,
) -> None:
    """Analyze clips again from their stored files.

    A worker that starts does this by itself for clips of an earlier version. Clips that are
    ready stay so, and searches find them, until the new analysis replaces the old one.
    """
    from app.cli.library import fit_if_due, working
    from app.services.clips import reanalysis

    with open_library(context) as lib:
        queued = reanalysis.requeue_outdated(lib)
        queued += reanalysis.requeue_ready(lib) if every else 0
        queued += reanalysis.requeue_failed(lib) if failed else 0
        if wait and _waiting(lib):
            with working(lib):
                _follow(lib)
                fit_if_due(lib)
        left = _waiting(lib)
    if as_json:
        print_json({"queued": queued, "waiting": left})
    else:
        typer.echo(f"{queued} clips queued, {left} waiting.")


def _follow(lib: Library) -> None:
    """Show the number of waiting clips until there is none."""
    from app.cli.library import POLL_S

    with progress_bar() as bar:
        total = _waiting(lib)
        task = bar.add_task("analysing", total=total)
        while left := _waiting(lib):
            bar.update(task, completed=total - left)
            time.sleep(POLL_S)
        bar.update(task, completed=total)


def _waiting(lib: Library) -> int:
    from app.store.clips import listing as clip_listing

    with lib.store.read() as tx:
        return clip_listing.count_waiting(tx)
