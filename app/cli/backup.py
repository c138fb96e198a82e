"""The command that copies the library while it is in use."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_store, settings_of
from app.errors import BadField, Place


def backup(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A new folder; it must not exist yet.")],
    as_json: AsJson = False,
) -> None:
    """Copy the library as it is now, while it is in use, into a new folder.

    The copy is a data directory: to restore it, start Kinedex with KINEDEX_DATA_DIR set to it, or
    to a copy of it. It holds everything, also keys (hashed) and what is deleted later.
    """
    from app.store.upkeep.backup import back_up

    _refuse_inside(settings_of(context).data_dir, path)
    with open_store(context) as store, _ended_by_sigterm(), progress_bar() as bar:
        task = bar.add_task("copying", total=None)
        made = back_up(
            store, path, lambda done, total: bar.update(task, completed=done, total=total)
        )
        bar.update(task, completed=1, total=1)
    if as_json:
        print_json({"path": str(made.path), "files": made.files, "bytes": made.bytes})
    else:
        typer.echo(f"{made.path}: the database and {made.files} files, {made.bytes} bytes")


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """In this block, SIGTERM raises an exception, so that an incomplete copy is removed."""
    before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _refuse_inside(data_dir: Path, path: Path) -> None:
    """Refuse a folder inside the library: it would be lost with it, and part of later copies."""
    if Path(os.path.realpath(data_dir)) in Path(os.path.realpath(path)).parents:
        message = f"{path} is inside the library ({data_dir}); choose a folder outside it"
        raise BadField(f"path: {message}", places=[Place("path", message)])
