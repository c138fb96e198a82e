"""Whether an SQLite database is whole: its pages, its indexes, and what its rows refer to."""

from __future__ import annotations

import sqlite3

from app.errors import StorageError

MAX_FINDINGS = 100
"""More tell nothing new."""

DAMAGED = frozenset({sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_IOERR})
"""SQLite's results that say that the file is damaged, or cannot be read."""


def find_damage(connection: sqlite3.Connection, *, quick: bool = False) -> tuple[str, ...]:
    """What is wrong, a sentence each; empty for a database that is whole.

    `quick` leaves out whether the indexes agree with their tables. Reads every page. Raises
    StorageError where it could not look.
    """
    check = "quick_check" if quick else "integrity_check"
    try:
        told = [row[0] for row in connection.execute(f"PRAGMA {check}({MAX_FINDINGS})")]
        dangling = connection.execute("PRAGMA foreign_key_check").fetchmany(MAX_FINDINGS)
    except sqlite3.Error as error:
        if not is_damage(error):
            raise StorageError(f"The database cannot be checked: {error}") from error
        return (str(error),)
    findings = [] if told == ["ok"] else told
    findings += [
        f"row {row} of {table} refers to a row of {parent} that is not there"
        for table, row, parent, _ in dangling
    ]
    return tuple(findings)


def is_damage(error: BaseException | None) -> bool:
    """Whether an error of SQLite says that the database is damaged."""
    code = getattr(error, "sqlite_errorcode", None)
    return code is not None and code & 0xFF in DAMAGED
