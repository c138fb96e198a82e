"""Troubles of the store are reported, and their end too."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.config import sqlite_url
from app.errors import DatabaseDamaged, DatabaseGone
from app.store import identity
from app.store.clips import versions as library
from app.store.files.id_file import write_id
from app.store.store import Store
from app.store.upkeep import health
from app.store.upkeep.health import Health
from tests.live import NET_S, wait_until


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Store]:
    url, files = sqlite_url(tmp_path / "kinedex.sqlite3"), tmp_path / "files"
    store = Store.open(url, files, identity.prepare(url, files))
    yield store
    store.close()


def locations(store: Store) -> list[str]:
    return [place.location for place in Health(store).troubles()]


def test_a_sound_store_has_no_trouble_and_keeps_no_probe(opened: Store, tmp_path: Path) -> None:
    assert locations(opened) == []
    assert not [path for path in tmp_path.rglob("*") if "probe" in path.name]


def test_a_database_that_was_moved_away_takes_no_more_writes(opened: Store, tmp_path: Path) -> None:
    path, away = tmp_path / "kinedex.sqlite3", tmp_path / "away"
    path.rename(away)
    assert locations(opened) == ["database"]
    with pytest.raises(DatabaseGone), opened.write() as tx:
        library.bump(tx)
    assert not path.exists()  # and none was made in its place
    away.rename(path)
    assert locations(opened) == []
    with opened.write() as tx:
        assert library.bump(tx) == 1


def test_another_file_in_its_place_is_seen(opened: Store, tmp_path: Path) -> None:
    path = tmp_path / "kinedex.sqlite3"
    shutil.copy(path, tmp_path / "another")
    (tmp_path / "another").replace(path)
    assert locations(opened) == ["database"]
    again = Store.open(sqlite_url(path), tmp_path / "files", opened.files.library_id)
    assert locations(again) == []  # a restart takes it
    again.close()


@pytest.mark.parametrize("harm", ["missing", "another"])
def test_a_folder_of_files_that_is_not_ours_is_seen(
    opened: Store, tmp_path: Path, harm: str
) -> None:
    files = tmp_path / "files"
    files.rename(tmp_path / "away")
    if harm == "another":
        write_id(files, "library_other")
    assert locations(opened) == ["files"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EROFS])
def test_a_disk_that_takes_nothing_is_seen(
    opened: Store, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    def fail(_folder: Path) -> None:
        raise OSError(code, os.strerror(code))

    watched = Health(opened)
    with monkeypatch.context() as broken:
        broken.setattr(health, "_try_to_write", fail)
        (place,) = watched.troubles()
        assert (place.location, os.strerror(code) in place.message) == ("disk", True)
    assert watched.troubles() == (place,)  # not tried at every look
    watched._next_write = 0.0
    assert watched.troubles() == ()


def test_damage_is_found_in_the_background_and_its_end_too(
    opened: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(health, "MIN_PAGE_CHECK_INTERVAL_S", 0.1)
    monkeypatch.setattr(health, "POLL_S", 0.05)
    path = tmp_path / "kinedex.sqlite3"
    opened.erase_traces()
    opened.database.engine.dispose()
    content = path.read_bytes()
    with path.open("r+b") as file:
        file.seek(5 * 4096)
        file.write(os.urandom(8 * 4096))
    watched = Health(opened)
    watched.start()
    try:
        wait_until(lambda: [p.location for p in watched.troubles()] == ["database"], NET_S)
        opened.database.engine.dispose()
        pool = opened.database.engine.pool
        with path.open("r+b") as file:
            file.write(content)
        wait_until(lambda: watched.troubles() == (), NET_S)
        # what the old connections keep in memory may be damaged
        assert opened.database.engine.pool is not pool
    finally:
        watched.stop()


def test_damage_that_a_transaction_meets_is_told_at_once(opened: Store) -> None:
    opened.erase_traces()
    path = opened.database.file.path  # type: ignore[union-attr]
    opened.database.engine.dispose()
    with path.open("r+b") as file:
        file.write(os.urandom(4096))  # the header too
    with pytest.raises(DatabaseDamaged), opened.read() as tx:
        library.version(tx)
    assert locations(opened) == ["database"]
