"""A sweep deletes only recorded files; other files that nobody names go to the quarantine."""

from __future__ import annotations

import io
import logging
import os
import time
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select

from app.errors import StorageError
from app.store.clips import repository as clips
from app.store.clips.record import AttachedAudio, ClipLabels, ClipRecord, NewClip
from app.store.database.engine import Tx
from app.store.database.tables import file_removals
from app.store.files.files import FileStore
from app.store.files.local_files import LocalFiles
from app.store.files.quarantine import DAY_S, FolderQuarantine
from app.store.jobs import imports, leases, outcomes, references
from app.store.jobs import repository as jobs
from app.store.jobs.imports import ImportOutcome, NewEntry
from app.store.jobs.record import JobKind, JobRecord, NewJob
from app.store.store import Store
from app.store.upkeep.sweep import SweepReport, sweep
from tests.store.conftest import facts

RETENTION_DAYS = 30.0


def put(files: FileStore, content: bytes) -> str:
    with files.stage(io.BytesIO(content)) as staged:
        staged.keep()
    return staged.sha256


def add(store: Store, name: str, **fields: Any) -> ClipRecord:
    """Adds a clip with its file, as an upload does."""
    with store.files.stage(io.BytesIO(name.encode())) as staged, store.write() as tx:
        staged.keep()
        new = NewClip(staged.sha256, f"{name}.bvh", staged.size, ClipLabels(name), **fields)
        return clips.add_or_get(tx, new).clip


def delete(store: Store, clip: ClipRecord) -> None:
    with store.write() as tx:
        outcomes.remove_clip(tx, clip.id)


def recorded(store: Store) -> set[str]:
    with store.read() as tx:
        return set(tx.execute(select(file_removals.c.sha256)).scalars())


def start_import(store: Store, content: bytes = b"a ZIP") -> tuple[JobRecord, str]:
    archive = put(store.files, content)
    with store.write() as tx:
        return jobs.enqueue(tx, NewJob(JobKind.IMPORT, file_sha256=archive)), archive


def test_the_files_of_a_deleted_clip_go_with_it(store: Store) -> None:
    skeleton, audio = put(store.files, b"skeleton"), put(store.files, b"audio")
    clip = add(store, "walk", skeleton_sha256=skeleton, audio=AttachedAudio(audio))
    other = add(store, "run", audio=AttachedAudio(audio))
    delete(store, clip)
    assert set(store.files) == {other.sha256, audio}
    delete(store, other)
    assert set(store.files) == set()
    assert recorded(store) == set()


def test_a_removal_that_a_crash_prevented_is_finished_by_the_next_sweep(store: Store) -> None:
    clip, orphan = add(store, "walk"), put(store.files, b"orphan")
    with store.database.write() as tx:  # committed, and killed before anything else
        outcomes.remove_clip(tx, clip.id)
    assert recorded(store) == {clip.sha256}
    assert store.files.has(clip.sha256)
    swept = sweep(store, RETENTION_DAYS)
    assert (swept.removed, swept.set_aside) == (1, 1)
    assert (store.files.has(clip.sha256), recorded(store)) == (False, set())
    assert list(store.files.quarantine) == [orphan]


def test_an_undone_deletion_removes_nothing(store: Store) -> None:
    clip = add(store, "walk")
    with pytest.raises(ZeroDivisionError), store.write() as tx:
        1 / len(outcomes.remove_clip(tx, clip.id).words)
    assert sweep(store, RETENTION_DAYS).removed == 0
    assert set(store.files) == {clip.sha256}


def test_a_file_that_is_stored_again_before_it_is_removed_stays(store: Store) -> None:
    clip = add(store, "walk")
    with store.database.write() as tx:
        outcomes.remove_clip(tx, clip.id)
    again = add(store, "walk")
    assert recorded(store) == set()
    assert set(store.files) == {again.sha256}


def test_a_file_that_cannot_be_removed_is_tried_again(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = add(store, "walk")

    def fail(*_: object) -> None:
        raise StorageError("The file store failed: Read-only file system")

    with monkeypatch.context() as broken:
        broken.setattr(LocalFiles, "remove", fail)
        delete(store, clip)
    assert recorded(store) == {clip.sha256}
    assert sweep(store, RETENTION_DAYS).removed == 1
    assert set(store.files) == set()


def claim_import(tx: Tx) -> Any:
    claimed = leases.claim(tx, [JobKind.IMPORT], "me")
    assert claimed is not None
    return claimed


@pytest.mark.parametrize("end", ["failed", "canceled", "canceled by its worker", "given up"])
def test_an_archive_goes_in_the_transaction_that_ends_its_import(store: Store, end: str) -> None:
    job, archive = start_import(store)
    with store.write() as tx:
        if end == "canceled":
            outcomes.request_cancel(tx, job.id)
        else:
            claimed = claim_import(tx)
    assert store.files.has(archive) is (end != "canceled")
    with store.write() as tx:
        if end == "failed":
            outcomes.fail_job(tx, claimed, {"code": "bad_content"})
        elif end == "canceled by its worker":
            outcomes.request_cancel(tx, job.id)
            outcomes.finish_canceled(tx, claimed)
        elif end == "given up":
            outcomes.retry_or_fail(tx, claimed, {"code": "storage"}, delay_s=0)
    assert store.files.has(archive) is (end == "given up")  # it is tried again, with its archive
    assert recorded(store) == set()


def test_an_archive_goes_when_it_is_unpacked_though_its_clips_are_not_analyzed(
    store: Store,
) -> None:
    job, archive = start_import(store)
    clip = add(store, "walk")
    with store.write() as tx:
        claimed = claim_import(tx)
        imports.add_entries(
            tx, job.id, [NewEntry("walk.bvh", ImportOutcome.QUEUED, clip_id=clip.id)]
        )
    assert store.files.has(archive)
    with store.write() as tx:
        assert imports.wait_for_clips(tx, claimed.lease).is_open
    assert not store.files.has(archive)
    with store.write() as tx:
        clips.set_ready(tx, clip.id, facts())
        outcomes.settle_imports(tx, [clip.id])
    with store.read() as tx:
        assert not jobs.get(tx, job.id).is_open


def test_an_archive_of_two_imports_goes_with_the_last(store: Store) -> None:
    (first, archive), (second, _) = start_import(store), start_import(store)
    for job, is_there in ((first, True), (second, False)):
        with store.write() as tx:
            outcomes.request_cancel(tx, job.id)
        assert store.files.has(archive) is is_there


def test_archives_that_an_earlier_kinedex_left_go_with_the_next_change(store: Store) -> None:
    job, archive = start_import(store)
    clip = add(store, "walk")
    with store.database.write() as tx:  # as that did
        outcomes.request_cancel(tx, job.id)
    assert store.files.has(archive)
    delete(store, clip)
    assert set(store.files) == set()


def test_files_that_nobody_names_are_set_aside_and_come_back(
    store: Store, caplog: pytest.LogCaptureFixture
) -> None:
    clip = add(store, "walk")
    orphans = {put(store.files, f"orphan {number}".encode()) for number in range(250)}
    with caplog.at_level(logging.WARNING):
        assert sweep(store, RETENTION_DAYS).set_aside == 250
    (line,) = [record for record in caplog.records if "moved to" in record.message]
    fields = line.fields  # type: ignore[attr-defined]
    assert (fields["count"], len(fields["files"])) == (250, 10)
    assert {name[:12] for name in orphans} >= set(fields["files"])
    assert set(store.files) == {clip.sha256}
    assert set(store.files.quarantine) == orphans
    named = add(store, "orphan 7")
    assert named.sha256 in orphans
    store.files.set_aside(named.sha256)  # as a sweep of an older database would
    assert sweep(store, RETENTION_DAYS).brought_back == 1
    assert store.files.path(named.sha256).read_bytes() == b"orphan 7"
    assert set(store.files.quarantine) == orphans - {named.sha256}
    assert sweep(store, RETENTION_DAYS) == SweepReport()


def test_what_is_forgotten_does_not_stay_in_the_quarantine(store: Store) -> None:
    clip = add(store, "walk")
    store.files.set_aside(clip.sha256)
    delete(store, clip)
    assert list(store.files.quarantine) == []


def test_a_file_that_is_being_stored_is_not_set_aside(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is kept before the sweep reads the database, committed before the sweep moves files."""
    late = put(store.files, b"late")
    real = references.referenced

    def ask_then_commit(tx: Tx) -> frozenset[str]:
        needed = real(tx)
        add(store, "late")
        return needed

    monkeypatch.setattr(references, "referenced", ask_then_commit)
    assert sweep(store, RETENTION_DAYS).set_aside == 0
    assert store.files.path(late).read_bytes() == b"late"


@pytest.fixture
def quarantine(tmp_path: Path) -> FolderQuarantine:
    """A quarantine with one file, which came now but was stored years ago."""
    made = FolderQuarantine(tmp_path / "quarantine")
    path = tmp_path / ("a" * 64)
    path.write_bytes(b"walk")
    os.utime(path, (1e9, 1e9))
    made.take(path)
    return made


def pass_days(monkeypatch: pytest.MonkeyPatch, days: float) -> None:
    now = time.time() + days * DAY_S
    monkeypatch.setattr("app.store.files.quarantine.time.time", lambda: now)


def test_the_retention_begins_with_the_move_and_ends_what_it_holds(
    quarantine: FolderQuarantine, monkeypatch: pytest.MonkeyPatch
) -> None:
    for day in range(1, 33):
        with monkeypatch.context() as later:
            pass_days(later, day - 0.5)
            purged = quarantine.purge(30 * DAY_S)
        assert bool(purged) is (day == 31), day
        assert list(quarantine) == ([] if day >= 31 else ["a" * 64])


@pytest.mark.parametrize("days", [20_000, -20_000])
def test_a_clock_that_jumps_ends_no_retention(
    quarantine: FolderQuarantine, monkeypatch: pytest.MonkeyPatch, days: float
) -> None:
    assert quarantine.purge(30 * DAY_S) == ()
    with monkeypatch.context() as later:
        pass_days(later, days)
        assert quarantine.purge(30 * DAY_S) == ()
        pass_days(later, 0.5)
        assert quarantine.purge(30 * DAY_S) == ()
    assert quarantine.purge(30 * DAY_S) == ()
    assert list(quarantine) == ["a" * 64]
