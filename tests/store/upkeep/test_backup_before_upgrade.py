"""A library is copied before its upgrade, with the schema of any earlier version."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import text

from app.config import sqlite_url
from app.errors import DatabaseOutOfDate, LibraryMismatch, StorageError
from app.store import identity
from app.store.clips import repository as clips
from app.store.database import schema
from app.store.database.engine import Database
from app.store.store import Store
from app.store.upkeep.backup import DATABASE, FILES, back_up
from tests.old_libraries import downgrade, make_library

REVISIONS = sorted(
    path.name[:4] for path in (schema.migrations_dir() / "versions").glob("[0-9]*.py")
)
EARLIER = REVISIONS[:-1]


def copy_of(folder: Path, path: Path) -> Path:
    """Copy a library as `kinedex backup` does."""
    url, files_dir = sqlite_url(folder / DATABASE), folder / FILES
    store = Store.open(url, files_dir, identity.check_copyable(url, files_dir))
    try:
        return back_up(store, path).path
    finally:
        store.close()


@pytest.mark.parametrize("revision", EARLIER)
def test_a_copy_is_made_with_an_earlier_schema_and_upgraded_after_it_is_restored(
    tmp_path: Path, revision: str
) -> None:
    made = make_library(tmp_path / "library")
    downgrade(tmp_path / "library", revision)
    copy = copy_of(tmp_path / "library", tmp_path / "copy")
    url = sqlite_url(copy / DATABASE)
    assert schema.state(url).current == revision
    with pytest.raises(DatabaseOutOfDate, match="kinedex backup"):
        identity.prepare(url, copy / FILES)
    schema.upgrade(url)
    restored = Store.open(url, copy / FILES, identity.prepare(url, copy / FILES))
    with restored.read() as tx:
        assert list(clips.get_many(tx, [clip.id for clip in made]).values()) == made
    for clip in made:
        with restored.files.open(clip.sha256) as file:
            assert file.read() == clip.name.encode()
    assert len(set(restored.files)) == 4
    restored.close()
    # The library itself was not changed.
    assert schema.state(sqlite_url(tmp_path / "library" / DATABASE)).current == revision


@pytest.mark.parametrize("revision", ["0001", "0005", "0007"])
def test_an_empty_library_with_an_earlier_schema_is_copied(tmp_path: Path, revision: str) -> None:
    url = sqlite_url(tmp_path / "library" / DATABASE)
    identity.prepare(url, tmp_path / "library" / FILES)
    downgrade(tmp_path / "library", revision)
    copy = copy_of(tmp_path / "library", tmp_path / "copy")
    assert {path.name for path in copy.iterdir()} == {DATABASE, FILES}


def test_a_file_that_is_missing_is_named_with_an_earlier_schema_too(tmp_path: Path) -> None:
    clip = make_library(tmp_path / "library")[0]
    downgrade(tmp_path / "library", "0004")
    (path,) = (tmp_path / "library" / FILES).glob(f"*/*/{clip.sha256}")
    path.unlink()
    with pytest.raises(StorageError, match="1 are missing"):
        copy_of(tmp_path / "library", tmp_path / "copy")
    assert not (tmp_path / "copy").exists()


@pytest.mark.parametrize("revision", ["0004", "0007"])
def test_files_of_another_library_are_not_copied_with_it(tmp_path: Path, revision: str) -> None:
    make_library(tmp_path / "library")
    downgrade(tmp_path / "library", revision)
    (tmp_path / "library" / FILES / "library-id").write_text("library_of_others\n")
    with pytest.raises(LibraryMismatch, match="library_of_others"):
        copy_of(tmp_path / "library", tmp_path / "copy")


@pytest.mark.parametrize(
    ("statement", "reason"),
    [
        ("UPDATE alembic_version SET version_num = '9999'", "newer Kinedex"),
        ("DELETE FROM alembic_version", "no schema version"),
    ],
)
def test_a_database_that_is_not_known_is_not_copied(
    tmp_path: Path, statement: str, reason: str
) -> None:
    make_library(tmp_path / "library")
    database = Database(sqlite_url(tmp_path / "library" / DATABASE))
    with database.write() as tx:
        tx.execute(text(statement))
    database.close()
    with pytest.raises(DatabaseOutOfDate, match=reason):
        copy_of(tmp_path / "library", tmp_path / "copy")
