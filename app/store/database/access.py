"""What a transaction does with the database, as an execution option of its connection."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from sqlalchemy import Connection

LOCK_TIMEOUT_S = 30.0
"""How long a writer waits for another one."""
_OPTION = "kinedex_access"


class Access(Enum):
    """The kinds of transactions."""

    READ = auto()
    """It reads one snapshot."""
    WRITE = auto()
    """It writes, and no other `WRITE` runs at the same time."""
    WRITE_ROW = auto()
    """It changes one row by one statement, and does not wait for writers of other rows."""


@dataclass(frozen=True, slots=True)
class ServerOptions:
    """How a process uses a database server; files of SQLite have no such options.

    connections: most of them at once; statement_timeout_s: seconds that one statement may take, 0
    for any time.
    """

    connections: int = 40
    statement_timeout_s: float = 300.0


def options_for(access: Access) -> dict[str, Access]:
    """The execution options of an engine whose transactions have this access."""
    return {_OPTION: access}


def access_of(connection: Connection) -> Access | None:
    """The access of a connection's transaction; None for one without these options."""
    access: Access | None = connection.get_execution_options().get(_OPTION)
    return access
