"""Transactions are durable, serialized and atomic."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import select

from app.config import sqlite_url
from app.errors import ConfigurationError, DiskFull, StorageError
from app.store.clips import versions as library
from app.store.clips.repository import add_or_get, get, set_failed
from app.store.database import engine, postgresql, sqlite
from app.store.database.engine import Database
from app.store.database.tables import clips
from app.store.store import Store
from tests.store.conftest import AddClip, new_clip


@pytest.mark.sqlite_only
def test_sqlite_is_opened_for_durability(store: Store) -> None:
    with store.read() as tx:
        settings = {
            name: tx.exec_driver_sql(f"PRAGMA {name}").scalar_one()
            for name in ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        }
    assert settings == {
        "journal_mode": "wal",
        "synchronous": 2,
        "foreign_keys": 1,
        "busy_timeout": engine.LOCK_TIMEOUT_S * 1000,
    }


def test_a_failed_write_leaves_nothing(store: Store) -> None:
    with pytest.raises(ZeroDivisionError), store.write() as tx:
        library.bump(tx) / 0
    with store.read() as tx:
        assert library.version(tx) == 0


@pytest.mark.sqlite_only
def test_a_write_in_a_read_transaction_is_rolled_back(store: Store) -> None:
    with store.read() as tx:
        library.bump(tx)
    with store.read() as tx:
        assert library.version(tx) == 0


def test_a_reader_sees_one_snapshot_and_does_not_stop_writers(store: Store) -> None:
    with store.read() as reading:
        before = library.version(reading)
        with store.write() as writing:
            library.bump(writing)
        assert library.version(reading) == before
    with store.read() as reading:
        assert library.version(reading) == before + 1


def test_threads_lose_no_update(store: Store) -> None:
    def bump_often() -> None:
        for _ in range(10):
            with store.write() as tx:
                library.bump(tx)

    threads = [threading.Thread(target=bump_often) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with store.read() as tx:
        assert library.version(tx) == 60


def test_many_threads_can_read_at_once(store: Store) -> None:
    barrier = threading.Barrier(40, timeout=300)
    seen = []

    def read() -> None:
        with store.read() as tx:
            barrier.wait()
            seen.append(library.version(tx))

    threads = [threading.Thread(target=read) for _ in range(40)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == [0] * 40


def test_a_lock_that_is_not_released_in_time_is_a_storage_error(
    store: Store, database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (engine, sqlite, postgresql):
        monkeypatch.setattr(module, "LOCK_TIMEOUT_S", 0.05)
    other = Database(database_url)
    with store.write() as tx:
        library.bump(tx)
        with pytest.raises(StorageError, match="stayed locked by another writer"), other.write():
            pass
        if store.database.is_sqlite:
            with pytest.raises(StorageError, match="this process"), store.write():
                pass
    other.close()


def test_a_nul_that_a_file_holds_becomes_a_mark_in_json(store: Store, add_clip: AddClip) -> None:
    """PostgreSQL cannot read it. A backslash before the same letters stays as it is."""
    clip = add_clip("walk")
    problem = {"detail": "joint a\0b", "more": [{"c\0": 1}, "d\\u0000"]}
    with store.write() as tx:
        set_failed(tx, clip.id, problem)
    with store.read() as tx:
        found = get(tx, clip.id).error
    assert found == {"detail": "joint a\ufffdb", "more": [{"c\ufffd": 1}, "d\\u0000"]}


@pytest.mark.sqlite_only
def test_a_full_disk_is_reported_and_nothing_is_stored(store: Store) -> None:
    with store.write() as tx:  # the limit belongs to the connection, which the pool reuses
        tx.exec_driver_sql("PRAGMA max_page_count = 1")
    with pytest.raises(DiskFull), store.write() as tx:
        add_or_get(tx, new_clip("a long name " + "x" * 100_000))
    with store.read() as tx:
        assert tx.execute(select(clips.c.id)).all() == []


@pytest.mark.parametrize("url", ["sqlite://", "sqlite:///:memory:", "not a url"])
def test_a_database_that_cannot_be_shared_is_refused(url: str) -> None:
    with pytest.raises(ConfigurationError):
        Database(url)


@pytest.mark.parametrize(
    "name", ["a?b", "a%20b", "%", "%3F", "a#b@c:d", "k?mode=ro", "é", "d\udcff"]
)
@pytest.mark.parametrize("opened", [Database.at, lambda path: Database(sqlite_url(path))])
def test_a_path_may_contain_any_characters(
    tmp_path: Path, name: str, opened: Callable[[Path], Database]
) -> None:
    path = tmp_path / name / name
    database = opened(path)
    with database.write() as tx:
        tx.exec_driver_sql("CREATE TABLE t (x)")
    database.close()
    assert path.is_file()
    assert [each.name for each in tmp_path.iterdir()] == [name]


def test_the_directory_of_the_database_is_made(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path}/a/b/k.sqlite3")
    with database.read() as tx:
        assert tx.exec_driver_sql("SELECT 1").scalar_one() == 1
    database.close()


@pytest.mark.sqlite_only
def test_a_file_is_written_anew_unless_it_is_too_large(
    store: Store, add_clip: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = add_clip("walk")
    assert store.rebuild()
    with store.read() as tx:
        assert get(tx, clip.id) == clip
    monkeypatch.setattr(engine, "MAX_REBUILT_BYTES", 0)
    assert not store.rebuild()
