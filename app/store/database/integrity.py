"""Checks an SQLite database for damage: its pages, its indexes and its foreign keys."""

from __future__ import annotations

import sqlite3

from app.errors import StorageError

MAX_FINDINGS = 100
"""Findings that are reported. More of them would add nothing."""

DAMAGED = frozenset({sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_IOERR})
"""Result codes of SQLite that mean that the file is damaged or cannot be read."""


def find_damage(connection: sqlite3.Connection, *, quick: bool = False) -> tuple[str, ...]:
    """The damage, one sentence for each finding; empty for a database without damage.

    It reads every page. `quick` skips the comparison of the indexes with their tables. Raises
    StorageError if the check itself is not possible.
    """
    check = "quick_check" if quick else "integrity_check"
    try:
        messages = [row[0] for row in connection.execute(f"PRAGMA {check}({MAX_FINDINGS})")]
        dangling = connection.execute("PRAGMA foreign_key_check").fetchmany(MAX_FINDINGS)
    except sqlite3.Error as error:
        if not is_damage(error):
            raise StorageError(f"The database cannot be checked: {error}") from error
        return (str(error),)
    findings = [] if messages == ["ok"] else messages
    findings += [
        f"row {row} of {table} refers to a row of {parent} that does not exist"
        for table, row, parent, _ in dangling
    ]
    return tuple(findings)


def is_damage(error: BaseException | None) -> bool:
    """Whether an error of SQLite means that the database is damaged."""
    code = getattr(error, "sqlite_errorcode", None)
    return code is not None and code & 0xFF in DAMAGED
