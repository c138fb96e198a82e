"""A library is copied whole while it is in use, or not at all."""

from __future__ import annotations

import hashlib
import io
import itertools
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from app.errors import BadField, ConfigurationError, StorageError
from app.store import backup, clips, jobs, outcomes, references
from app.store.backup import Backup, back_up
from app.store.clip_record import ClipRecord, NewClip
from app.store.engine import Database
from app.store.job_record import JobKind, NewJob
from app.store.store import Store

Add = Callable[[str], ClipRecord]


@pytest.fixture
def add(store: Store) -> Add:
    """Adds a clip with a file, as an upload does."""

    def one(name: str) -> ClipRecord:
        content = name.encode()
        with store.files.stage(io.BytesIO(content)) as staged, store.write() as tx:
            staged.keep()
            new = NewClip(staged.sha256, f"{name}.bvh", staged.size, name)
            return clips.add_or_get(tx, new).clip

    return one


def delete(store: Store, clip: ClipRecord) -> None:
    with store.write() as tx:
        outcomes.remove_clip(tx, clip.id)
    store.drop_unreferenced([clip.sha256])


def restored(made: Backup) -> Store:
    return Store.open(f"sqlite:///{made.path / backup.DATABASE}", made.path / backup.FILES)


def check_whole(made: Backup) -> set[str]:
    """That each file is there with its bytes, and no other; the names of the clips."""
    copy = restored(made)
    try:
        with copy.read() as tx:
            needed = references.referenced(tx)
            names = set(tx.exec_driver_sql("SELECT name FROM clips").scalars())
            assert tx.exec_driver_sql("PRAGMA integrity_check").scalar() == "ok"
        assert set(copy.files) == needed
        for sha256 in needed:
            with copy.files.open(sha256) as file:
                assert hashlib.sha256(file.read()).hexdigest() == sha256
        return names
    finally:
        copy.close()


def test_everything_is_copied_and_can_be_worked_on(store: Store, add: Add, tmp_path: Path) -> None:
    add("walk"), add("run")
    with store.files.stage(io.BytesIO(b"an archive")) as staged, store.write() as tx:
        staged.keep()
        jobs.enqueue(tx, NewJob(JobKind.IMPORT, file_sha256=staged.sha256))
    told: list[tuple[int, int]] = []
    made = back_up(store, tmp_path / "new" / "copy", lambda *steps: told.append(steps))
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert check_whole(made) == {"walk", "run"}
    assert (made.files, made.bytes > 4096) == (3, True)
    assert {path.name for path in made.path.iterdir()} == {backup.DATABASE, backup.FILES}
    assert [path.name for path in made.path.parent.iterdir()] == ["copy"]
    copy = restored(made)
    with copy.write() as tx:  # and the original does not see it
        assert len(jobs.list_jobs(tx).items) == 1
        clips.patch(tx, next(iter(clips.get_many(tx, [add("walk").id]))), {"name": "mine"})
    copy.close()
    assert add("walk").name == "walk"


def test_what_is_there_is_never_replaced(store: Store, add: Add, tmp_path: Path) -> None:
    add("walk")
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("mine")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.iterdir())
    for name in ("folder", "file", "link", "file/below"):
        with pytest.raises(BadField, match="path: "):
            back_up(store, tmp_path / name)
    assert sorted(tmp_path.iterdir()) == before
    assert (tmp_path / "file").read_text() == "mine"


def test_what_is_deleted_before_its_turn_is_left_out(
    store: Store, add: Add, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, doomed = add("kept"), add("doomed")
    copy_to, moments = Database.copy_to, []

    def copy_then_delete(database: Database, path: Path) -> None:
        """A clip comes before the copy of the database, and is deleted right after it."""
        late = add(f"late {len(moments)}")
        if not moments:
            delete(store, doomed)  # whose file was copied already
        copy_to(database, path)
        if len(moments) < 2:
            delete(store, late)
        moments.append(late.name)

    monkeypatch.setattr(Database, "copy_to", copy_then_delete)
    made = back_up(store, tmp_path / "copy")
    assert moments == ["late 0", "late 1", "late 2"]
    assert check_whole(made) == {kept.name, "late 2"}


@pytest.mark.parametrize("harm", ["lost", "damaged"])
def test_a_library_that_is_not_whole_is_not_copied(
    store: Store, add: Add, tmp_path: Path, harm: str
) -> None:
    add("walk")
    path = store.files.path(add("run").sha256)
    path.unlink() if harm == "lost" else path.write_bytes(b"ruined")
    told = {"lost": "1 files that the library refers to are not there", "damaged": "is damaged"}
    with pytest.raises(StorageError, match=told[harm]) as refused:
        back_up(store, tmp_path / "copy")
    assert path.name in refused.value.detail
    assert not [name for name in tmp_path.iterdir() if "copy" in name.name]


def test_a_library_in_use_is_copied_as_it_was_at_one_moment(
    store: Store, add: Add, tmp_path: Path
) -> None:
    for number in range(20):
        add(f"old {number}")
    stop = threading.Event()

    def use() -> None:
        """Clips come, and go in the order in which they came."""
        here: list[ClipRecord] = []
        for number in itertools.count():
            here.append(add(f"new {number:05}"))
            if len(here) > 3:
                delete(store, here.pop(0))
            if stop.is_set():
                return

    with ThreadPoolExecutor(1) as pool:
        using = pool.submit(use)
        try:
            made = [back_up(store, tmp_path / f"copy {number}") for number in range(3)]
        finally:
            stop.set()
        using.result()
    for one in made:
        names = check_whole(one)
        assert {name for name in names if name.startswith("old")} == {
            f"old {number}" for number in range(20)
        }
        new = sorted(int(name.split()[1]) for name in names if name.startswith("new"))
        assert len(new) <= 4
        assert new == [new[0] + place for place in range(len(new))]


def test_another_database_is_refused(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store.database, "_is_sqlite", False)
    with pytest.raises(ConfigurationError, match="pg_dump"):
        back_up(store, tmp_path / "copy")
    assert not (tmp_path / "copy").exists()
