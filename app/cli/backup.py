"""The command that copies the library while it is in use."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.output import AsJson, print_json, progress_bar
from app.cli.settings import open_store, settings_of
from app.errors import BadField, StorageError
from app.kinedex_error import Place

if TYPE_CHECKING:
    from app.store.store import Store


def backup(
    context: typer.Context,
    path: Annotated[Path, typer.Argument(help="A new folder; it must not exist yet.")],
    as_json: AsJson = False,
) -> None:
    """Copy the library into a new folder; the library may be in use.

    The copy is a data directory: to restore it, start Kinedex with KINEDEX_DATA_DIR set to it, or
    to a copy of it. With PostgreSQL it holds a dump, which needs pg_dump on this machine; `kinedex
    db restore` loads it. The database may still have the schema of an earlier version, as before an
    upgrade. The copy contains everything: also the hashed API keys, and clips that you delete from
    the library later.
    """
    from app.store.upkeep.backup import back_up

    _refuse_inside(settings_of(context).data_dir, path)
    with open_store(context, for_copy=True) as store, exit_on_sigterm(), progress_bar() as bar:
        task = bar.add_task("copying", total=None)
        copy = back_up(
            store, path, lambda done, total: bar.update(task, completed=done, total=total)
        )
        bar.update(task, completed=1, total=1)
        _record(context, store)
    if as_json:
        print_json({"path": str(copy.path), "files": copy.files, "bytes": copy.bytes})
    else:
        typer.echo(f"{copy.path}: the database and {copy.files} files, {copy.bytes} bytes")


def _record(context: typer.Context, store: Store) -> None:
    """Record the copy in the audit log, if the library has the schema of this version."""
    from app.store import audit
    from app.store.database import schema

    if schema.state(settings_of(context).database).is_current:
        with suppress(StorageError), store.write() as tx:  # a copy of a full disk is welcome too
            audit.add(tx, audit.Call("kinedex backup"))


@contextmanager
def exit_on_sigterm() -> Iterator[None]:
    """In this block, SIGTERM raises SystemExit, so that `back_up` removes an incomplete copy."""
    previous_handler = signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous_handler)


def _refuse_inside(data_dir: Path, path: Path) -> None:
    """Raise BadField if `path` is inside the data directory.

    Such a copy would be lost together with the library, and later copies would contain it.
    """
    # symbolic links are resolved, because one may lead into the data directory
    if Path(os.path.realpath(data_dir)) in Path(os.path.realpath(path)).parents:
        message = f"{path} is inside the library ({data_dir}); choose a folder outside it"
        raise BadField(f"path: {message}", places=[Place("path", message)])
