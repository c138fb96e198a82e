"""A database and a folder of files that do not belong together are refused and not changed."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from alembic import command

from app.config import sqlite_url
from app.errors import LibraryMismatch, StorageError
from app.store import identity
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.record import ClipLabels, NewClip
from app.store.database import schema
from app.store.database.engine import Database
from app.store.files.id_file import NAME, read_id, write_id
from app.store.store import Store
from app.store.upkeep.sweep import sweep

Open = Callable[..., Store]


def open_library(folder: Path, database: str = "kinedex.sqlite3") -> Store:
    """Opens a library in the way of every start."""
    url, files = sqlite_url(folder / database), folder / "files"
    return Store.open(url, files, identity.prepare(url, files))


def add(store: Store, *names: str) -> list[str]:
    """Adds clips with one file each, as uploads do; returns the names of the files."""
    made = []
    for name in names:
        with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
            staged.keep()
            new = NewClip(staged.sha256, f"{name}.bvh", staged.size, ClipLabels(name))
            made.append(clips.add_or_get(tx, new).clip.sha256)
    return made


def state_of(folder: Path) -> dict[str, bytes]:
    """The content of every file below a folder, by path."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A library with three clips, closed."""
    store = open_library(tmp_path / "data")
    add(store, "walk", "run", "jump")
    store.close()
    return tmp_path / "data"


def test_a_new_library_has_one_id_on_both_sides(tmp_path: Path) -> None:
    store = open_library(tmp_path)
    with store.read() as tx:
        ours = library.library_id(tx)
    store.close()
    assert read_id(tmp_path / "files") == ours == store.files.library_id
    again = open_library(tmp_path)
    assert again.files.library_id == ours
    again.close()
    other = open_library(tmp_path / "other")
    assert other.files.library_id != ours
    other.close()


def test_a_start_without_its_moved_database_is_refused(folder: Path) -> None:
    moved = folder.parent / "elsewhere"
    moved.mkdir()
    for path in folder.glob("kinedex.sqlite3*"):
        path.rename(moved / path.name)
    before = state_of(folder)
    with pytest.raises(LibraryMismatch, match=r"no library in .*kinedex.sqlite3.*3 files"):
        open_library(folder)
    assert state_of(folder) == before  # not even an empty database
    for path in moved.iterdir():
        path.rename(folder / path.name)
    store = open_library(folder)
    assert sweep(store, 30).set_aside == 0
    store.close()


@pytest.mark.parametrize("leaves_id", [True, False])
def test_a_new_database_is_refused_for_a_used_folder_of_files(
    folder: Path, leaves_id: bool
) -> None:
    """A wrong URL, also with a folder from an early Kinedex, which wrote no id."""
    if not leaves_id:
        (folder / "files" / NAME).unlink()
    with pytest.raises(LibraryMismatch):
        open_library(folder, "mistyped.sqlite3")
    assert not (folder / "mistyped.sqlite3").exists()
    schema.upgrade(sqlite_url(folder / "empty.sqlite3"))
    before = {name: data for name, data in state_of(folder).items() if "files" in name}
    with pytest.raises(LibraryMismatch, match="adopt-files"):
        open_library(folder, "empty.sqlite3")
    assert {n: d for n, d in state_of(folder).items() if "files" in n} == before


def test_an_empty_library_whose_database_was_moved_is_refused_too(tmp_path: Path) -> None:
    open_library(tmp_path).close()
    (tmp_path / "kinedex.sqlite3").unlink()
    with pytest.raises(LibraryMismatch):
        open_library(tmp_path)


def test_two_libraries_cannot_share_a_folder(tmp_path: Path) -> None:
    open_library(tmp_path, "one.sqlite3").close()
    schema.upgrade(sqlite_url(tmp_path / "two.sqlite3"))
    with pytest.raises(LibraryMismatch, match=r"two\.sqlite3 is the database of the library"):
        open_library(tmp_path, "two.sqlite3")
    open_library(tmp_path, "one.sqlite3").close()


@pytest.mark.parametrize("how", ["gone", "empty"])
def test_a_database_without_its_files_is_refused(folder: Path, how: str) -> None:
    """A folder that is not mounted, or a wrong data directory."""
    (folder / "files").rename(folder / "away")
    if how == "empty":
        (folder / "files").mkdir()
    with pytest.raises(LibraryMismatch, match=r"names 3 files, and the folder .* holds 0 of them"):
        open_library(folder)
    assert not (folder / "files" / NAME).exists()


def test_an_old_library_gets_its_id(folder: Path) -> None:
    """It is upgraded from a schema without ids, and has an archive that no import needs."""
    url = sqlite_url(folder / "kinedex.sqlite3")
    database = Database(url, foreign_keys=False)
    with database.migrate() as tx:
        command.downgrade(schema._config(tx), "0005")
    database.close()
    (folder / "files" / NAME).unlink()
    archive = folder / "files" / "ab" / "cd" / ("abcd" + 60 * "0")
    archive.parent.mkdir(parents=True)
    archive.write_bytes(b"a ZIP")
    schema.upgrade(url)
    store = open_library(folder)
    assert read_id(folder / "files") == store.files.library_id
    assert (sweep(store, 30).set_aside, archive.exists()) == (1, False)
    store.close()


def test_a_start_finishes_an_earlier_one_that_wrote_only_one_id(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "kinedex.sqlite3")
    schema.prepare(url)  # and killed here
    store = open_library(tmp_path)
    assert read_id(tmp_path / "files") == store.files.library_id
    store.close()


def test_only_one_of_two_libraries_gets_a_folder(tmp_path: Path) -> None:
    write_id(tmp_path, "library_one")
    write_id(tmp_path, "library_two")
    assert read_id(tmp_path) == "library_one"
    write_id(tmp_path, "library_two", replaces=True)
    assert read_id(tmp_path) == "library_two"
    assert [path.name for path in tmp_path.iterdir()] == [NAME]


def test_an_operator_can_assign_a_folder_to_a_database(folder: Path) -> None:
    url, files = sqlite_url(folder / "other.sqlite3"), folder / "files"
    with pytest.raises(LibraryMismatch, match="no library"):
        identity.adopt(url, files)
    schema.upgrade(url)
    found = identity.adopt(url, files)
    assert (found.present, found.missing, found.unknown) == (0, 0, 3)
    store = open_library(folder, "other.sqlite3")
    store.close()
    with pytest.raises(LibraryMismatch):  # the first one notices
        open_library(folder)
    found = identity.adopt(sqlite_url(folder / "kinedex.sqlite3"), files)
    assert (found.present, found.missing, found.unknown) == (3, 0, 0)
    open_library(folder).close()


def test_nothing_is_stored_in_a_folder_that_changed_while_it_was_open(folder: Path) -> None:
    store = open_library(folder)
    (folder / "files").rename(folder / "unmounted")
    for _ in range(2):
        with pytest.raises(StorageError, match="not the one of this library"):
            add(store, "late")
        with pytest.raises(StorageError):
            sweep(store, 30)
        (folder / "files").mkdir(exist_ok=True)
    assert list((folder / "files").iterdir()) == []
    (folder / "files").rmdir()
    (folder / "unmounted").rename(folder / "files")
    add(store, "late")
    store.close()


@pytest.mark.parametrize("first", ["database", "files"])
def test_restoring_in_any_order_loses_nothing(folder: Path, first: str) -> None:
    """An older database is restored and used before the newer one, or the files come later."""
    older, newer = folder.parent / "older.sqlite3", folder.parent / "newer.sqlite3"
    shutil.copy(folder / "kinedex.sqlite3", older)
    store = open_library(folder)
    late = add(store, "late 1", "late 2")
    store.erase_traces()
    store.close()
    shutil.copy(folder / "kinedex.sqlite3", newer)
    everything = set(store.files)
    if first == "database":
        shutil.copy(older, folder / "kinedex.sqlite3")
        store = open_library(folder)
        assert sweep(store, 30).set_aside == 2
        assert set(store.files) == everything - set(late)
        store.close()
    else:  # the newer database comes while only the older files are there
        for sha256 in late:
            store.files.set_aside(sha256)
    shutil.copy(newer, folder / "kinedex.sqlite3")
    store = open_library(folder)
    with store.files.open(late[0]) as file:  # before any sweep
        assert file.read() == b"late 1"
    assert sweep(store, 30).brought_back == 1
    assert set(store.files) == everything
    assert list(store.files.quarantine) == []
    store.close()
