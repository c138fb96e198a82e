"""A library moves to PostgreSQL and to a bucket: every row and file, whatever interrupts it."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy import func, select, update

from app.errors import BadField, LibraryMismatch, StorageError
from app.store import identity
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, ClipRecord, NewClip
from app.store.database.columns import metadata
from app.store.database.engine import Database
from app.store.database.tables import clip_arrays, clip_words
from app.store.database.tables import clips as clips_table
from app.store.files.places import open_files
from app.store.jobs import outcomes
from app.store.store import Store
from app.store.upkeep import move as moving
from app.store.upkeep.backup import back_up
from app.store.upkeep.move import move, open_target
from tests import buckets, databases
from tests.store.conftest import facts

pytestmark = pytest.mark.sqlite_only


@pytest.fixture
def store(database_url: str, tmp_path: Path) -> Iterator[Store]:
    at = tmp_path / "files"
    opened = Store.open(database_url, at, identity.prepare(database_url, at))
    yield opened
    opened.close()


@pytest.fixture
def target_url(tmp_path: Path) -> Iterator[str]:
    with databases.of_kind(databases.POSTGRESQL), databases.released():
        yield databases.url_for(tmp_path / "target", is_empty=True)


@pytest.fixture
def target(target_url: str) -> Iterator[Database]:
    opened = open_target(target_url)
    yield opened
    opened.close()


def add(store: Store, name: str, content: bytes | None = None) -> ClipRecord:
    with store.files.stage(io.BytesIO(content or name.encode())) as staged, store.write() as tx:
        staged.keep()
        labels = ClipLabels(name, person="Ada \u00e9", words=("walk", "slow"))
        new = NewClip(staged.sha256, f"{name}.bvh", staged.size, labels)
        clip = clips.add_or_get(tx, new).clip
        clips.set_ready(tx, clip.id, facts())
        data = np.random.default_rng(3).normal(size=(7, 3))
        arrays.put_many(tx, clip.id, {"positions": data, "times": data[:, 0]}, version=1)
        return clips.get(tx, clip.id)


def everything(database: Database) -> dict[str, list[Any]]:
    with database.read() as tx:
        return {
            table.name: sorted(
                (repr(moving._values(row)) for row in tx.execute(select(table))), key=str
            )
            for table in metadata.sorted_tables
        }


def test_every_row_and_file_moves_and_the_target_works(
    store: Store, target_url: str, target: Database, tmp_path: Path
) -> None:
    walk = add(store, "walk")
    for number in range(5):
        add(store, f"clip {number}")
    made = move(store, target)
    assert (made.written, made.removed, made.files) == (made.rows, 0, 6)
    with pytest.raises(LibraryMismatch):  # nobody starts on half a move
        identity.check(target_url, store.files.root)
    late = add(store, "late")
    with store.write() as tx:
        outcomes.remove_clip(tx, walk.id)
        clips.patch(tx, late.id, {"person": "Bob"})
    again = move(store, target, switch=True)
    assert 0 < again.written < again.rows
    assert again.removed > 0
    assert everything(target) == everything(store.database)
    moved = Store.open(target_url, store.files.root, identity.check(target_url, store.files.root))
    with moved.read() as tx:
        assert clips.get(tx, late.id).person == "Bob"
        assert np.array_equal(
            arrays.get_one(tx, late.id, "positions"), np.random.default_rng(3).normal(size=(7, 3))
        )
    add(moved, "new")
    moved.close()
    with pytest.raises(BadField, match="moved there already"):
        move(store, target)


@pytest.mark.parametrize("table", [clips_table, clip_words, clip_arrays])
def test_a_move_that_was_interrupted_goes_on(
    store: Store, target: Database, monkeypatch: pytest.MonkeyPatch, table: Any
) -> None:
    monkeypatch.setattr(moving, "ROWS_AT_ONCE", 3)
    monkeypatch.setattr(moving, "ARRAYS_AT_ONCE", 3)
    for number in range(8):
        add(store, f"clip {number}")

    def stop(what: str, done: int, _total: int) -> None:
        if what == table.name and done >= 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        move(store, target, progress=stop)
    with target.read() as tx:
        copied = tx.execute(select(func.count()).select_from(table)).scalar_one()
    assert copied == 3
    made = move(store, target, switch=True)
    assert 0 < made.written <= made.rows - 3
    assert everything(target) == everything(store.database)


def test_a_row_that_somebody_changed_in_the_target_is_found(
    store: Store, target: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk = add(store, "walk")
    move(store, target)
    with target.write() as tx:
        tx.execute(update(clips_table).values(name="wolk"))
    assert move(store, target).written == 1

    def tamper(what: str, done: int, total: int) -> None:
        if what == "comparing" and done == 0:
            with target.write() as tx:
                tx.execute(update(clip_arrays).values(data=b"0"))

    with pytest.raises(StorageError, match="clip_arrays differ"):
        move(store, target, switch=True, progress=tamper)
    move(store, target, switch=True)
    with target.read() as tx:
        assert clips.get(tx, walk.id).name == "walk"


def test_another_library_is_not_overwritten(
    store: Store, target: Database, target_url: str, tmp_path: Path
) -> None:
    other_files = tmp_path / "other"
    other = Store.open(target_url, other_files, identity.prepare(target_url, other_files))
    add(other, "theirs")
    before = everything(target)
    with pytest.raises(BadField, match="another library"):
        move(store, target)
    assert everything(target) == before
    other.close()


def test_files_move_to_a_bucket(
    store: Store, target: Database, target_url: str, tmp_path: Path
) -> None:
    names = {add(store, f"clip {number}").sha256 for number in range(4)}
    with buckets.running() as s3:
        bucket = s3.new(tmp_path / "machine")
        files = open_files(bucket, store.files.library_id)
        assert move(store, target, files).copied == 4
        damaged = min(names)
        s3.write(bucket, f"{damaged[:2]}/{damaged[2:4]}/{damaged}", b"damaged")
        names.add(add(store, "late").sha256)
        assert move(store, target, files, switch=True).copied == 1
        assert set(files) == names
        for name in names:
            files.check(name)
        moved = Store.open(target_url, bucket, identity.check(target_url, bucket))
        add(moved, "new")
        with moved.files.removal_hold.held(), moved.files.removal_hold.free() as is_free:
            assert not is_free
        with moved.files.removal_hold.free() as is_free:
            assert is_free
        moved.close()


def test_a_backup_of_a_bucket_goes_back_into_another_one(
    store: Store, database_url: str, tmp_path: Path
) -> None:
    with buckets.running() as s3:
        first, second = s3.new(tmp_path / "one"), s3.new(tmp_path / "two")
        used = Store.open(database_url, first, store.files.library_id)
        used.files.write_id(store.files.library_id or "")
        names = {add(used, f"clip {number}").sha256 for number in range(3)}
        back_up(used, tmp_path / "copy")
        used.close()
        assert moving.restore_files_to(second, tmp_path / "copy") == 3
        restored = open_files(second, store.files.library_id)
        restored.check_identity()
        assert set(restored) == names
        for name in names:
            restored.check(name)


def test_a_damaged_file_is_named(store: Store, target: Database, tmp_path: Path) -> None:
    walk = add(store, "walk")
    store.files.path(walk.sha256).write_bytes(b"wolk")
    other = open_files(tmp_path / "elsewhere", store.files.library_id)
    with pytest.raises(StorageError, match="damaged") as refused:
        move(store, target, other, switch=True)
    assert [place.location for place in refused.value.places] == [walk.sha256]
