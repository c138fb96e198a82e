"""A library is copied completely while it is in use, or not at all."""

from __future__ import annotations

import errno
import hashlib
import io
import itertools
import os
import random
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import insert, select

from app.config import sqlite_url
from app.errors import BadField, DatabaseDamaged, StorageError
from app.store import identity
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.record import ClipLabels, ClipRecord, NewClip
from app.store.database import schema
from app.store.database.engine import Database
from app.store.database.tables import file_removals
from app.store.files.local_files import LocalFiles
from app.store.jobs import outcomes, references
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store
from app.store.upkeep import backup, dump
from app.store.upkeep.backup import Backup, back_up
from tests import databases

Add = Callable[[str], ClipRecord]


@pytest.fixture(autouse=True)
def _programs(database_kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if database_kind == databases.POSTGRESQL:
        programs = databases.postgresql_server().programs
        monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")


@pytest.fixture
def add(store: Store) -> Add:
    """Adds a clip with a file, as an upload does."""

    def one(name: str) -> ClipRecord:
        content = name.encode()
        with store.files.stage(io.BytesIO(content)) as staged, store.write() as tx:
            staged.keep()
            new = NewClip(staged.sha256, f"{name}.bvh", staged.size, ClipLabels(name))
            return clips.add_or_get(tx, new).clip

    return one


def delete(store: Store, clip: ClipRecord) -> None:
    with store.write() as tx:
        outcomes.remove_clip(tx, clip.id)


def url_of(made: Backup) -> str:
    """The URL of the database in a copy; a dump is loaded into a new database at first."""
    if databases.is_sqlite():
        return sqlite_url(made.path / backup.DATABASE)
    url = databases.url_for(made.path, is_empty=True)
    if schema.state(url).is_empty:
        dump.restore(url, made.path)
    return url


def restored(made: Backup) -> Store:
    return Store.open(url_of(made), made.path / backup.FILES)


def check_whole(made: Backup) -> set[str]:
    """Checks that the copy has exactly the files of its clips; returns the names of the clips."""
    copy = restored(made)
    try:
        with copy.read() as tx:
            needed = references.referenced(tx)
            names = set(tx.exec_driver_sql("SELECT name FROM clips").scalars())
        assert copy.database.find_damage() == ()
        assert set(copy.files) == needed
        for sha256 in needed:
            with copy.files.open(sha256) as file:
                assert hashlib.sha256(file.read()).hexdigest() == sha256
        return names
    finally:
        copy.close()


def test_everything_is_copied_and_kinedex_can_use_the_copy(
    store: Store, add: Add, tmp_path: Path
) -> None:
    add("walk"), add("run")
    with store.files.stage(io.BytesIO(b"an archive")) as staged, store.write() as tx:
        staged.keep()
        jobs.enqueue(tx, NewJob(JobKind.IMPORT, file_sha256=staged.sha256))
    steps_seen: list[tuple[int, int]] = []
    made = back_up(store, tmp_path / "new" / "copy", lambda *steps: steps_seen.append(steps))
    assert steps_seen == [(1, 3), (2, 3), (3, 3)]
    assert check_whole(made) == {"walk", "run"}
    assert (made.files, made.bytes > 4096) == (3, True)
    database = backup.DATABASE if databases.is_sqlite() else backup.DUMP
    assert {path.name for path in made.path.iterdir()} == {database, backup.FILES}
    assert [path.name for path in made.path.parent.iterdir()] == ["copy"]
    copy = restored(made)
    with copy.write() as tx:  # and the original does not see it
        assert len(jobs.list_jobs(tx).items) == 1
        clips.patch(tx, next(iter(clips.get_many(tx, [add("walk").id]))), {"name": "mine"})
    copy.close()
    assert add("walk").name == "walk"


def test_an_existing_path_is_never_replaced(store: Store, add: Add, tmp_path: Path) -> None:
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


def test_a_clip_deleted_after_the_database_was_copied_is_in_the_copy(
    store: Store, add: Add, tmp_path: Path
) -> None:
    deleted, last = add("deleted"), add("last")

    def delete_once(done: int, _: int) -> None:
        if done == 1:  # whose file is the next one
            for clip in (deleted, last):
                delete(store, clip)

    made = back_up(store, tmp_path / "copy", delete_once)
    assert check_whole(made) == {"deleted", "last"}
    add("next")  # any change removes the files whose removal waited
    assert not store.files.has(deleted.sha256)
    assert not store.files.has(last.sha256)


def test_every_missing_or_damaged_file_is_named_and_nothing_is_copied(
    store: Store, add: Add, tmp_path: Path
) -> None:
    add("walk")
    lost = [add(f"lost {number}").sha256 for number in range(3)]
    damaged = [add(f"damaged {number}").sha256 for number in range(2)]
    for sha256 in lost:
        store.files.path(sha256).unlink()
    for sha256 in damaged:
        store.files.path(sha256).write_bytes(b"ruined")
    with pytest.raises(StorageError, match="3 are missing and 2 are damaged") as refused:
        back_up(store, tmp_path / "copy")
    reported = {place.location: place.message for place in refused.value.places}
    assert reported == dict.fromkeys(lost, "is missing") | dict.fromkeys(damaged, "is damaged")
    assert not [name for name in tmp_path.iterdir() if "copy" in name.name]


def test_a_file_that_the_disk_cannot_read_is_named_too(
    store: Store, add: Add, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = {add("walk").sha256, add("run").sha256}

    class Unreadable(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(LocalFiles, "open", lambda *_: Unreadable())
    with pytest.raises(StorageError, match="2 are damaged") as refused:
        back_up(store, tmp_path / "copy")
    assert {place.location for place in refused.value.places} == names


@pytest.mark.sqlite_only
def test_a_damaged_database_is_not_copied(store: Store, add: Add, tmp_path: Path) -> None:
    for number in range(200):
        add(f"walk {number}")
    assert back_up(store, tmp_path / "good").files == 200
    overwrite_pages(store)
    with pytest.raises(DatabaseDamaged) as refused:
        back_up(store, tmp_path / "copy")
    assert refused.value.places or "damaged" in refused.value.detail
    assert not [name for name in tmp_path.iterdir() if "copy" in name.name]


@pytest.mark.sqlite_only
def test_rows_that_refer_to_nothing_are_damage(store: Store, add: Add, tmp_path: Path) -> None:
    add("walk")
    loose = Database(sqlite_url(tmp_path / "kinedex.sqlite3"), foreign_keys=False)
    with loose.write() as tx:
        tx.exec_driver_sql("INSERT INTO clip_words VALUES ('clip_none', 'walk', 0)")
    loose.close()
    with pytest.raises(DatabaseDamaged) as refused:
        back_up(store, tmp_path / "copy")
    (place,) = refused.value.places
    assert "clip_words refers to a row of clips that does not exist" in place.message


def overwrite_pages(store: Store) -> None:
    """Overwrites all pages of the database but the first with noise, as a bad disk may do."""
    store.erase_traces()  # moves the changes from the log into the file
    path = store.database.file.path  # type: ignore[union-attr]
    store.close()
    pages = path.stat().st_size // 4096
    draw = random.Random(5)
    with path.open("r+b") as file:
        for page in draw.sample(range(1, pages), min(40, pages - 1)):
            file.seek(page * 4096)
            file.write(draw.randbytes(4096))


@contextmanager
def killed_backup(folder: Path, name: str) -> Iterator[Path]:
    """The unfinished copy of a process that was killed while it copied to `folder / name`."""
    code = (
        "import os, sys, pathlib, functools\n"
        "from app.store.files import locked_file\n"
        "from app.store.upkeep import backup\n"
        "path = pathlib.Path(sys.argv[1])\n"
        "with locked_file.locked_folder(functools.partial(backup._make_part, path)) as part:\n"
        "    (part / 'files').mkdir()\n"
        "    (part / 'kinedex.sqlite3').write_bytes(b'half')\n"
        "    print(part, flush=True)\n"
        "    sys.stdin.read()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(folder / name)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield Path(process.stdout.readline().strip())
    finally:
        process.kill()
        process.communicate()


def test_the_next_backup_removes_the_rest_of_a_killed_one(
    store: Store, add: Add, tmp_path: Path
) -> None:
    add("walk")
    others = tmp_path / ".mine.part"
    others.mkdir()
    (others / "notes.txt").write_text("not a copy")
    with killed_backup(tmp_path, "monday") as part:
        back_up(store, tmp_path / "tuesday")
        assert part.is_dir()  # its maker lives
    assert part.is_dir()
    back_up(store, tmp_path / "wednesday")
    assert not part.exists()
    assert (others / "notes.txt").exists()


def test_a_copy_is_private_and_has_the_id_of_its_library(
    store: Store, add: Add, tmp_path: Path
) -> None:
    add("walk")
    made = back_up(store, tmp_path / "copy")
    assert made.path.stat().st_mode & 0o777 == 0o700
    with store.read() as tx:
        assert identity.check(url_of(made), made.path / backup.FILES) == library.library_id(tx)


def test_a_copy_removes_nothing_when_it_is_used(store: Store, add: Add, tmp_path: Path) -> None:
    """A removal that was recorded at the time of the copy is not done in the restored library."""
    add("walk")
    with store.database.write() as tx:  # which does not finish it
        tx.execute(insert(file_removals), {"sha256": "0" * 64})
    made = back_up(store, tmp_path / "copy")
    copy = restored(made)
    with copy.read() as tx:
        assert not tx.execute(select(file_removals)).all()
    copy.close()


def test_a_library_in_use_is_copied_as_it_was_at_one_moment(
    store: Store, add: Add, tmp_path: Path
) -> None:
    for number in range(20):
        add(f"old {number}")
    stop = threading.Event()

    def use() -> None:
        """Adds clips, and deletes them in the order in which it added them."""
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
