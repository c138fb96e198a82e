"""Upgrades copies of a database, each killed (SIGKILL) before another of its statements.

    python -m tests.faults.killed_upgrade DATABASE FOLDER EVERY

Writes one database for each killed upgrade to FOLDER (EVERY: 1 kills at every statement, 2 at every
second one...) and prints the number of statements of a whole upgrade. The children are forked, so
that the modules are imported once.
"""

from __future__ import annotations

import os
import shutil
import signal
import sys
from pathlib import Path

import alembic.command  # noqa: F401 - so that no child imports it
from sqlalchemy import Engine, event

from app.config import sqlite_url
from app.store.database import schema

KILLED = -signal.SIGKILL


def _upgrade(path: Path, kill_at: int) -> int:
    """Upgrade in a child that is killed before statement `kill_at`; returns its exit code."""
    child = os.fork()
    if child == 0:
        count = 0

        def before(*_: object) -> None:
            nonlocal count
            count += 1
            if count == kill_at:
                os.kill(os.getpid(), signal.SIGKILL)

        event.listen(Engine, "before_cursor_execute", before)
        event.listen(Engine, "commit", before)
        schema.upgrade(sqlite_url(path))
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def main(database: Path, folder: Path, every: int) -> None:
    """See the module."""
    statement = 0
    while True:
        statement += every
        path = folder / f"killed-{statement}.sqlite3"
        shutil.copy(database, path)
        if _upgrade(path, statement) != KILLED:
            path.unlink()
            break
    sys.stdout.write(f"{statement}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
