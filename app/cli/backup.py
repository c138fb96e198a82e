"""Copying the library while it is in use (DESIGN 12)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import settings_of
from app.errors import BadField, ConfigurationError, Place


def backup(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A folder that is not there yet.")],
    as_json: AsJson = False,
) -> None:
    """Copy the library as it is now, while it is in use, into a new folder.

    The copy is a data directory: to restore it, start Kinedex with KINEDEX_DATA_DIR set to it, or
    to a copy of it. It holds everything, also keys (hashed) and what is deleted later.
    """
    from app.store import schema
    from app.store.backup import DATABASE, back_up
    from app.store.store import Store

    settings = settings_of(context)
    if settings.database_url is None and not (settings.data_dir / DATABASE).is_file():
        raise ConfigurationError(f"There is no library in {settings.data_dir}.")
    _refuse_inside(settings.data_dir, path)
    schema.check(settings.database)
    store = Store.open(settings.database, settings.files_dir)
    try:
        with progress_bar() as bar:
            task = bar.add_task("copying", total=None)
            made = back_up(
                store, path, lambda done, total: bar.update(task, completed=done, total=total)
            )
            bar.update(task, completed=1, total=1)
    finally:
        store.close()
    if as_json:
        print_json({"path": str(made.path), "files": made.files, "bytes": made.bytes})
    else:
        typer.echo(f"{made.path}: the database and {made.files} files, {made.bytes} bytes")


def _refuse_inside(data_dir: Path, path: Path) -> None:
    """A copy there would be lost with the library, and be copied with it whenever it is."""
    if Path(os.path.realpath(data_dir)) in Path(os.path.realpath(path)).parents:
        message = f"{path} lies in the library itself ({data_dir}): name a folder outside it"
        raise BadField(f"path: {message}", places=[Place("path", message)])
