"""The dump of a PostgreSQL database: what stops it, and where it may be loaded."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from app.errors import BadField, ConfigurationError, StorageError
from app.store.store import Store
from app.store.upkeep import dump
from app.store.upkeep.backup import back_up
from tests import databases

pytestmark = pytest.mark.postgresql_only


@pytest.fixture(autouse=True)
def _programs(monkeypatch: pytest.MonkeyPatch) -> None:
    programs = databases.postgresql_server().programs
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")


def test_without_the_programs_of_postgresql_nothing_is_copied(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ConfigurationError, match="pg_dump and pg_restore"):
        back_up(store, tmp_path / "copy")
    assert not (tmp_path / "copy").exists()


def test_what_a_program_says_is_reported_and_no_copy_is_left(store: Store, tmp_path: Path) -> None:
    with store.write() as tx:
        tx.exec_driver_sql("CREATE ROLE stranger LOGIN")
    stranger = store.database.engine.url.set(username="stranger")
    other = Store.open(stranger.render_as_string(hide_password=False), store.files.root)
    with pytest.raises(StorageError, match="permission denied"):
        back_up(other, tmp_path / "copy")
    assert not [name for name in tmp_path.iterdir() if "copy" in name.name]
    other.close()
    with store.write() as tx:
        tx.exec_driver_sql("DROP ROLE stranger")


def test_a_dump_is_loaded_only_into_an_empty_database(
    store: Store, database_url: str, tmp_path: Path
) -> None:
    made = back_up(store, tmp_path / "copy")
    with pytest.raises(BadField, match="not empty"):
        dump.restore(database_url, made.path)
    with pytest.raises(BadField, match="no dump"):
        dump.restore(databases.url_for(tmp_path / "new", is_empty=True), tmp_path)
