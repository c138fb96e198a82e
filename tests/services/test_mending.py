"""What is damaged is mended, or marked; and nothing is deleted."""

from __future__ import annotations

import io
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import update

from app.config import sqlite_url
from app.errors import BadField, StoredFileMissing
from app.services.mending import MendReport, examine, mend
from app.store import identity, models
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, ClipRecord, ClipState, NewClip, Reanalysis
from app.store.database.tables import clip_arrays, model_arrays
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind
from app.store.store import Store
from app.store.upkeep.backup import FILES, back_up
from tests.store.conftest import facts
from tests.store.upkeep.test_backup import overwrite_pages
from tests.store.upkeep.test_file_watch import flip

MOTION = {
    "positions": np.zeros((4, 13, 3), np.float32),
    "parents": np.zeros(13, np.int32),
    "joint_names": np.frombuffer(b"[]", np.uint8),
}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    url, files = sqlite_url(tmp_path / "data" / "kinedex.sqlite3"), tmp_path / "data" / FILES
    return Store.open(url, files, identity.prepare(url, files))


@pytest.fixture
def made(store: Store) -> list[ClipRecord]:
    """Three ready clips with their arrays."""
    found = []
    for name in ("walk", "run", "jump"):
        with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
            staged.keep()
            new = NewClip(staged.sha256, name, staged.size, ClipLabels(name))
            clip = clips.add_or_get(tx, new).clip
            arrays.put_many(tx, clip.id, MOTION, version=1)
            clips.set_ready(tx, clip.id, facts(warnings=()))
            found.append(clips.get(tx, clip.id))
    return found


def clip_now(store: Store, clip: ClipRecord) -> ClipRecord:
    with store.read() as tx:
        return clips.get(tx, clip.id)


def break_array(store: Store, clip: ClipRecord, name: str = "positions") -> None:
    its = (clip_arrays.c.clip_id == clip.id, clip_arrays.c.name == name)
    with store.write() as tx:
        tx.execute(update(clip_arrays).where(*its).values(shape="5x13x3"))


def mended(store: Store, backup: Path | None = None) -> MendReport:
    return mend(store, examine(store), backup)


def test_a_whole_library_is_not_changed(store: Store, made: list[ClipRecord]) -> None:
    assert mended(store) == MendReport()
    assert [clip_now(store, clip) for clip in made] == made


def test_bad_files_come_back_from_a_backup(
    store: Store, made: list[ClipRecord], tmp_path: Path
) -> None:
    backup = back_up(store, tmp_path / "backup").path
    flipped, lost, _ = made
    flip(store.files.path(flipped.sha256))
    store.files.path(lost.sha256).unlink()
    report = mended(store, backup)
    assert sorted(report.restored) == sorted([flipped.sha256, lost.sha256])
    assert examine(store).is_whole
    assert [clip_now(store, clip) for clip in made] == made


def test_a_backup_with_the_same_damage_mends_nothing_and_the_clip_says_why(
    store: Store, made: list[ClipRecord], tmp_path: Path
) -> None:
    backup = back_up(store, tmp_path / "backup").path
    flipped, lost, whole = made
    for folder in (backup / FILES, store.files.root):
        flip(folder / flipped.sha256[:2] / flipped.sha256[2:4] / flipped.sha256)
        (folder / lost.sha256[:2] / lost.sha256[2:4] / lost.sha256).unlink()
    damaged = store.files.path(flipped.sha256).read_bytes()
    report = mended(store, backup)
    assert (report.restored, sorted(report.marked)) == ([], sorted([flipped.id, lost.id]))
    assert report.left == sorted([flipped.sha256, lost.sha256])
    assert store.files.path(flipped.sha256).read_bytes() == damaged  # a person may read most of it
    for clip, code in ((flipped, "file_damaged"), (lost, "file_missing")):
        now = clip_now(store, clip)
        assert now.state is ClipState.READY
        (warning,) = now.warnings
        assert (warning.code, clip.sha256 in warning.detail) == (code, True)
    assert clip_now(store, whole) == whole
    assert mended(store, backup).marked == []  # they have their warnings already

    with store.files.stage(io.BytesIO(b"run")) as staged:
        staged.keep()  # somebody sends the file again
    report = mended(store)
    assert report.cleared == [lost.id]
    assert clip_now(store, lost).warnings == ()
    assert clip_now(store, flipped).warnings


def test_arrays_that_cannot_be_read_are_computed_again(
    store: Store, made: list[ClipRecord]
) -> None:
    broken, lacking, _ = made
    break_array(store, broken)
    with store.write() as tx:
        its = (clip_arrays.c.clip_id == lacking.id, clip_arrays.c.name == "parents")
        tx.execute(clip_arrays.delete().where(*its))
    assert examine(store).unreadable == (f"{broken.id}/positions",)
    assert examine(store).lacking == (f"{lacking.id}/parents",)
    assert sorted(mended(store).queued) == sorted([broken.id, lacking.id])
    for clip in (broken, lacking):
        now = clip_now(store, clip)
        assert (now.state, now.reanalysis) == (ClipState.READY, Reanalysis.QUEUED)


def test_a_clip_without_its_file_and_its_arrays_fails_and_is_analyzed_when_the_file_is_back(
    store: Store, made: list[ClipRecord], tmp_path: Path
) -> None:
    backup = back_up(store, tmp_path / "backup").path
    clip = made[0]
    break_array(store, clip)
    store.files.path(clip.sha256).unlink()
    assert mended(store).failed == [clip.id]
    now = clip_now(store, clip)
    assert now.error is not None
    assert (now.state, now.error["code"]) == (ClipState.FAILED, "file_missing")
    assert "kinedex doctor --mend" in now.error["detail"]
    report = mended(store, backup)
    assert (report.restored, report.queued) == ([clip.sha256], [clip.id])
    assert clip_now(store, clip).state is ClipState.QUEUED


def test_a_clip_whose_analysis_failed_for_want_of_its_file_is_queued_once(
    store: Store, made: list[ClipRecord]
) -> None:
    clip = made[0]
    with store.write() as tx:
        clips.set_failed(tx, clip.id, StoredFileMissing().as_problem())
    assert mended(store).queued == [clip.id]
    assert mended(store).queued == []


def test_a_model_with_a_broken_array_is_fitted_again(store: Store) -> None:
    with store.write() as tx:
        models.save(tx, "cca", meta={}, arrays=MOTION, library_version=1, library_size=1)
        tx.execute(update(model_arrays).values(shape="7"))
    assert mended(store).is_fit_queued
    with store.read() as tx:
        (job,) = jobs.list_jobs(tx, limit=10).items
    assert job.kind is JobKind.FIT


def test_an_index_that_does_not_fit_its_table_is_built_again(
    store: Store, made: list[ClipRecord]
) -> None:
    path = store.database.file.path  # type: ignore[union-attr]
    store.erase_traces()
    store.close()
    named = "name = 'ix_clips_person'"
    with closing(sqlite3.connect(path)) as opened:  # takes the index away while rows change
        opened.execute("PRAGMA writable_schema = ON")
        row = opened.execute(f"SELECT * FROM sqlite_master WHERE {named}").fetchone()
        opened.execute(f"DELETE FROM sqlite_master WHERE {named}")
        opened.commit()
    with closing(sqlite3.connect(path)) as opened:
        opened.execute("UPDATE clips SET person = 'ada'")
        opened.execute("PRAGMA writable_schema = ON")
        opened.execute("INSERT INTO sqlite_master VALUES (?, ?, ?, ?, ?)", row)
        opened.commit()
    assert "missing from index" in examine(store).damage[0]
    assert mended(store).has_rebuilt_indexes
    assert examine(store).is_whole
    assert {clip_now(store, clip).person for clip in made} == {"ada"}


def test_damaged_tables_are_left_for_a_whole_backup(store: Store, made: list[ClipRecord]) -> None:
    overwrite_pages(store)
    before = store.database.file.path.read_bytes()  # type: ignore[union-attr]
    assert mended(store) == MendReport()
    assert store.database.file.path.read_bytes() == before  # type: ignore[union-attr]


def test_a_folder_without_files_is_no_backup(
    store: Store, made: list[ClipRecord], tmp_path: Path
) -> None:
    shutil.copytree(store.files.root, tmp_path / "elsewhere" / FILES)
    mended(store, tmp_path / "elsewhere")
    with pytest.raises(BadField, match="no backup"):
        mended(store, tmp_path / "nowhere")
