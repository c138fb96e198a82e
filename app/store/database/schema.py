"""The schema's version: upgrading a database, and refusing one of another version.

Alembic upgrades. It takes a quarter of a second to import, so what every start asks (which
revision the database has, and which one this code needs) is answered without it: migrations
are files called NNNN_what.py, where NNNN is the revision.
"""

from __future__ import annotations

import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import inspect, text

from app.errors import DatabaseOutOfDate, StorageError
from app.store.database.engine import Database, Tx

if TYPE_CHECKING:
    from alembic.config import Config

REVISION_TABLE = "alembic_version"
"""Where Alembic keeps a database's revision."""
IN_CHECKOUT = Path(__file__).resolve().parents[3] / "migrations"
IN_INSTALLATION = Path(sysconfig.get_path("data")) / "share" / "kinedex" / "migrations"


@dataclass(frozen=True, slots=True)
class SchemaState:
    """Revision of a database (None: it has none) beside the one that this code needs."""

    current: str | None
    needed: str
    is_empty: bool

    @property
    def is_current(self) -> bool:
        """Whether this code can run on the database."""
        return self.current == self.needed


def migrations_dir() -> Path:
    """The migrations, in a checkout (or the image's copy of one) or as a wheel installs them."""
    for place in (IN_CHECKOUT, IN_INSTALLATION):
        if (place / "env.py").is_file():
            return place
    raise StorageError("The database migrations were not installed with Kinedex")


def upgrade(database_url: str) -> SchemaState:
    """Brings the database to this code's schema, in one transaction; an empty one is filled.

    Harmless when it is there already, and when two processes do it at once. Raises
    DatabaseOutOfDate where the database is of a newer Kinedex, or of no Kinedex at all.
    """
    from alembic import command

    # Rebuilding a table under enforced foreign keys would delete what refers to it.
    database = Database(database_url, foreign_keys=False)
    try:
        with database.migrate() as tx:
            found = _state(tx)
            _refuse_newer(found)
            if found.current is None and not found.is_empty:
                raise DatabaseOutOfDate(
                    "The database has tables but no schema version: it is none of Kinedex's, or "
                    "it is damaged"
                )
            command.upgrade(_config(tx), "head")
            return _state(tx)
    finally:
        database.close()


def state(database_url: str) -> SchemaState:
    """How the database stands to this code."""
    database = Database(database_url)
    try:
        with database.read() as tx:
            return _state(tx)
    finally:
        database.close()


def check(database_url: str) -> None:
    """Raises DatabaseOutOfDate, telling what to do, unless the schema is this code's."""
    found = state(database_url)
    if found.is_current:
        return
    _refuse_newer(found)
    raise DatabaseOutOfDate(
        f"The database has schema {found.current or 'none'}, this Kinedex needs {found.needed}: "
        "stop all its processes, make a copy, and run `kinedex db upgrade`"
    )


def _refuse_newer(found: SchemaState) -> None:
    if found.current is not None and found.current not in _known_revisions():
        raise DatabaseOutOfDate(
            f"The database is of a newer Kinedex (schema {found.current}, this one knows "
            f"{found.needed}): install that version"
        )


def prepare(database_url: str) -> None:
    """What a start does: fills an empty database, checks any other."""
    if state(database_url).is_empty:
        upgrade(database_url)
    check(database_url)


def _config(tx: Tx) -> Config:
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(migrations_dir()).replace("%", "%%"))
    config.attributes["connection"] = tx
    return config


def _known_revisions() -> frozenset[str]:
    files = (migrations_dir() / "versions").glob("[0-9]*_*.py")
    return frozenset(file.name.partition("_")[0] for file in files)


def _state(tx: Tx) -> SchemaState:
    tables = inspect(tx).get_table_names()
    current = None
    if REVISION_TABLE in tables:
        current = tx.execute(text(f"SELECT version_num FROM {REVISION_TABLE}")).scalar()  # noqa: S608
    return SchemaState(current, max(_known_revisions()), is_empty=not tables)
