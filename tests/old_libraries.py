"""Libraries as earlier versions of Kinedex left them."""

from __future__ import annotations

import io
from pathlib import Path

from alembic import command

from app.config import sqlite_url
from app.store import identity
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, ClipRecord, NewClip
from app.store.database import schema
from app.store.database.engine import Database
from app.store.store import Store
from app.store.upkeep.backup import DATABASE, FILES

WITH_ID = "0006"
"""The first revision in which a library has an id."""


def make_library(folder: Path) -> list[ClipRecord]:
    """A library with three clips; one of them needs a skeleton file."""
    url, files_dir = sqlite_url(folder / DATABASE), folder / FILES
    store = Store.open(url, files_dir, identity.prepare(url, files_dir))
    made = []
    for name in ("walk", "run", "kick"):
        with (
            store.files.stage(io.BytesIO(name.encode())) as motion,
            store.files.stage(io.BytesIO(b"a skeleton")) as skeleton,
            store.write() as tx,
        ):
            motion.keep(), skeleton.keep()
            other = skeleton.sha256 if name == "kick" else None
            new = NewClip(
                motion.sha256, f"{name}.amc", motion.size, ClipLabels(name), skeleton_sha256=other
            )
            made.append(clips.add_or_get(tx, new).clip)
    store.close()
    return made


def downgrade(folder: Path, revision: str) -> None:
    """Give the library the schema of an earlier version, as that version left it."""
    database = Database(sqlite_url(folder / DATABASE), foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), revision)
    database.close()
    if revision < WITH_ID:
        (folder / FILES / "library-id").unlink()
