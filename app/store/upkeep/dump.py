"""Dumps a PostgreSQL database into a file, and loads such a file, by PostgreSQL's own programs.

The dump shows the snapshot of one transaction (`pg_export_snapshot`), in which also the names of
the files are read: so both belong together, while others write.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from sqlalchemy import func, select
from sqlalchemy.engine import URL

from app.errors import BadField, ConfigurationError, DiskFull, StorageError
from app.kinedex_error import Place
from app.store.database import postgresql, schema
from app.store.database.engine import Database
from app.store.database.tables import file_removals
from app.store.jobs import references

DUMP = "kinedex.dump"
"""Name of the file in a backup."""
DUMP_PROGRAM, LOAD_PROGRAM = "pg_dump", "pg_restore"
MAX_LINES = 3
"""Lines of what a program says that are repeated."""
_NO_SPACE = "No space left on device"


def check_programs() -> None:
    """Raises ConfigurationError, which says what to do, if the programs are not installed."""
    missing = [name for name in (DUMP_PROGRAM, LOAD_PROGRAM) if shutil.which(name) is None]
    if missing:
        raise ConfigurationError(
            f"To copy a PostgreSQL database, Kinedex needs {' and '.join(missing)}, at least of"
            " the version of the server: install them (Debian: postgresql-client). Or copy by hand:"
            " the folder of files, then the database (pg_dump on the server), then what is new in"
            " the folder."
        )


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A moment of the database. needed: the names of the files that it needs."""

    needed: frozenset[str]
    _url: URL
    _name: str

    def dump(self, path: Path) -> None:
        """Dumps this moment into a new file. Raises DiskFull, StorageError."""
        _run(
            DUMP_PROGRAM,
            self._url,
            "--format=custom",
            "--no-owner",
            "--no-privileges",
            f"--snapshot={self._name}",
            # The copy has no files to remove, and a file that is stored there later must stay.
            f"--exclude-table-data={file_removals.name}",
            f"--file={path}",
        )
        _check(path)


@contextmanager
def snapshot(database: Database) -> Iterator[Snapshot]:
    """The present moment of the database, as long as the block runs. Raises StorageError."""
    with database.read() as tx:
        postgresql.lift_time_limits(tx)
        name = tx.execute(select(func.pg_export_snapshot())).scalar_one()
        yield Snapshot(references.referenced_in_any_schema(tx), database.engine.url, name)


def restore(database_url: str, backup: Path) -> None:
    """Loads the dump of a backup into an empty database, in one transaction.

    Raises BadField without a dump, or if the database is not empty; ConfigurationError, DiskFull,
    StorageError. Then the database stays as it is.
    """
    if not (backup / DUMP).is_file():
        _refuse("path", f"{backup} has no dump of a PostgreSQL database ({DUMP})")
    if not schema.state(database_url).is_empty:
        _refuse("database", "it is not empty: make a new one, and name it in KINEDEX_DATABASE_URL")
    check_programs()
    database = Database(database_url)
    try:
        url = database.engine.url
    finally:
        database.close()
    options = ("--no-owner", "--no-privileges", "--exit-on-error", "--single-transaction")
    _run(LOAD_PROGRAM, url, *options, str(backup / DUMP))


def _refuse(field: str, message: str) -> NoReturn:
    raise BadField(f"{field}: {message}", places=[Place(field, message)])


def _check(path: Path) -> None:
    """Raises StorageError if the file is no whole dump: reads its table of contents."""
    _finish([_found(LOAD_PROGRAM), "--list", str(path)], os.environ)


def _run(program: str, url: URL, *arguments: str) -> None:
    # The password is not an argument, which every process of the machine could read.
    environment = os.environ | ({"PGPASSWORD": str(url.password)} if url.password else {})
    command = [_found(program), f"--dbname={_connection(url)}", *arguments]
    _finish(command, environment)


def _found(program: str) -> str:
    return shutil.which(program) or program


def _connection(url: URL) -> str:
    """How to connect, without the password, as PostgreSQL's programs read it."""
    named = {
        "user": url.username,
        "host": url.host,
        "port": url.port,
        "dbname": url.database,
        **url.query,
    }
    pairs = [(name, value) for name, value in named.items() if value is not None]
    return " ".join(f"{name}='{_escaped(value)}'" for name, value in pairs)


def _escaped(value: object) -> str:
    text = ",".join(value) if isinstance(value, Sequence) and not isinstance(value, str) else value
    return str(text).replace("\\", "\\\\").replace("'", "\\'")


def _finish(command: Sequence[str], environment: Mapping[str, str]) -> None:
    """Runs a program. Raises DiskFull or StorageError, with what it said, if it fails."""
    ended = subprocess.run(  # noqa: S603 - no shell
        command, env=environment, capture_output=True, text=True, errors="replace", check=False
    )
    if not ended.returncode:
        return
    if _NO_SPACE in ended.stderr:
        raise DiskFull
    said = "; ".join(ended.stderr.strip().splitlines()[:MAX_LINES])
    raise StorageError(f"{Path(command[0]).name} failed: {said or 'it gave no reason'}")
