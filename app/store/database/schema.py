"""The version of the schema: upgrades a database, and refuses one with another version.

Alembic does the upgrade. To import it takes a quarter of a second. So the check at every start
(the revision of the database, and the revision that this code needs) does not use it: migrations
are files called NNNN_what.py, where NNNN is the revision.
"""

from __future__ import annotations

import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Column, inspect, text

from app.errors import DatabaseOutOfDate, StorageError
from app.store.database import postgresql
from app.store.database.engine import Database, Tx

if TYPE_CHECKING:
    from alembic.config import Config

REVISION_TABLE = "alembic_version"
"""The table in which Alembic stores the revision."""
IN_CHECKOUT = Path(__file__).resolve().parents[3] / "migrations"
IN_INSTALLATION = Path(sysconfig.get_path("data")) / "share" / "kinedex" / "migrations"


@dataclass(frozen=True, slots=True)
class SchemaState:
    """The revision of a database.

    current: its revision, None if it has none; needed: the revision that this code needs;
    is_empty: whether it has no tables.
    """

    current: str | None
    needed: str
    is_empty: bool

    @property
    def is_current(self) -> bool:
        """Whether this code can run on the database."""
        return self.current == self.needed


def migrations_dir() -> Path:
    """The folder of migrations: in a checkout (or the image's copy of it), or from a wheel.

    Raises StorageError if neither exists.
    """
    for folder in (IN_CHECKOUT, IN_INSTALLATION):
        if (folder / "env.py").is_file():
            return folder
    raise StorageError("The database migrations were not installed with Kinedex")


def upgrade(database_url: str) -> SchemaState:
    """Upgrades the database to the schema of this code, in one transaction.

    An empty database gets all tables. Nothing happens if the schema is current; two processes may
    call it at the same time. Raises DatabaseOutOfDate if a newer Kinedex or another program made
    the database.
    """
    from alembic import command

    # A migration rebuilds a table by deleting it. With foreign keys that would also delete the
    # rows of other tables that refer to it.
    database = Database(database_url, foreign_keys=False)
    try:
        with database.migrate() as tx:
            status = _state(tx)
            _refuse_newer(status)
            if status.current is None and not status.is_empty:
                raise DatabaseOutOfDate(
                    "The database has tables but no schema version: another program made it, or "
                    "it is damaged"
                )
            command.upgrade(_config(tx), "head")
            if not database.is_sqlite:
                postgresql.collate(tx)
            return _state(tx)
    finally:
        database.close()


def state(database_url: str) -> SchemaState:
    """The revision of the database and the revision that this code needs."""
    database = Database(database_url)
    try:
        with database.read() as tx:
            return _state(tx)
    finally:
        database.close()


def check(database_url: str) -> None:
    """Raises DatabaseOutOfDate if the schema is not current; the message says what to do."""
    status = state(database_url)
    if status.is_current:
        return
    _refuse_newer(status)
    raise DatabaseOutOfDate(
        f"The database has schema {status.current or 'none'}, this Kinedex needs {status.needed}: "
        "stop all its processes, make a copy (`kinedex backup`), and run `kinedex db upgrade`"
    )


def _refuse_newer(status: SchemaState) -> None:
    if status.current is not None and status.current not in _revisions():
        raise DatabaseOutOfDate(
            f"The database is from a newer Kinedex (its schema is {status.current}, this Kinedex "
            f"needs {status.needed}): install the newer version"
        )


def check_known(database_url: str) -> None:
    """As `check`, but the schema may also be an older one of Kinedex, as before an upgrade."""
    status = state(database_url)
    _refuse_newer(status)
    if status.current is None:
        raise DatabaseOutOfDate("The database has no schema version: it is no library of Kinedex")


def has_column(tx: Tx, column: Column[Any]) -> bool:
    """Whether the database has the column. A database with an older schema may not have it."""
    found, table = inspect(tx), column.table.name
    return found.has_table(table) and column.name in {c["name"] for c in found.get_columns(table)}


def prepare(database_url: str) -> None:
    """Makes the tables of an empty database, and checks any other."""
    if state(database_url).is_empty:
        upgrade(database_url)
    check(database_url)


def _config(tx: Tx) -> Config:
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(migrations_dir()).replace("%", "%%"))
    config.attributes["connection"] = tx
    return config


def _revisions() -> frozenset[str]:
    files = (migrations_dir() / "versions").glob("[0-9]*_*.py")
    return frozenset(file.name.partition("_")[0] for file in files)


def _state(tx: Tx) -> SchemaState:
    tables = inspect(tx).get_table_names()
    current = None
    if REVISION_TABLE in tables:
        current = tx.execute(text(f"SELECT version_num FROM {REVISION_TABLE}")).scalar()  # noqa: S608 - a constant
    return SchemaState(current, max(_revisions()), is_empty=not tables)
