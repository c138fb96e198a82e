"""The census counts clips, jobs, failures and models."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import insert, update

from app.errors import Unreadable
from app.store import models
from app.store.database.ids import utc_now
from app.store.database.tables import clips as clips_table
from app.store.database.tables import jobs as jobs_table
from app.store.jobs import leases
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, NewJob
from app.store.store import Store
from app.store.upkeep import census
from tests.cpu_time import cpu_seconds_below
from tests.store.conftest import AddClip


def test_an_empty_library_has_nothing_to_count(store: Store) -> None:
    found = census.count(store)
    assert (found.jobs, found.clips, found.oldest, found.failed_jobs) == ({}, {}, {}, {})
    assert (found.failed_clips, found.models, found.stages) == ({}, {}, ())


def test_everything_is_counted(store: Store, add_clip: AddClip) -> None:
    add_clip("walk", ready=True), add_clip("run", ready=True), add_clip("kick"), add_clip("bow")
    problem = Unreadable("no motion").as_problem()
    with store.write() as tx:
        for _ in range(3):
            jobs.enqueue(tx, NewJob(JobKind.IMPORT))
        claimed = leases.claim(tx, [JobKind.IMPORT], "worker")
        assert claimed is not None
        leases.fail(tx, claimed.lease, problem)
        old = datetime(2020, 1, 2, tzinfo=UTC)
        waiting = jobs.enqueue(tx, NewJob(JobKind.FIT))
        tx.execute(update(jobs_table).where(jobs_table.c.id == waiting.id).values(created_at=old))
        tx.execute(
            update(clips_table)
            .where(clips_table.c.name == "kick")
            .values(state="failed", error=problem)
        )
        models.save(
            tx, "words", meta={}, arrays={"a": np.zeros(1)}, library_version=1, library_size=2
        )
        tx.execute(update(clips_table).where(clips_table.c.name == "bow").values(state="failed"))
    found = census.count(store)
    assert found.clips == {"ready": 2, "failed": 2}
    assert found.failed_clips == {"unreadable": 1, census.UNKNOWN: 1}
    assert found.jobs == {
        ("import", "queued"): 2,
        ("import", "failed"): 1,
        ("fit", "queued"): 1,
    }
    assert found.failed_jobs == {("import", "unreadable"): 1}
    assert found.oldest[("fit", "queued")] == old
    assert ("import", "failed") not in found.oldest
    assert utc_now() - found.models["words"] < timedelta(hours=1)


def test_the_free_space_and_the_size_of_the_database_are_measured(
    store: Store, tmp_path: Path
) -> None:
    store.files.root.mkdir(exist_ok=True)
    found = census.measure_space(store)
    if store.database.file is None:  # its disk is another machine's
        assert (set(found.free), found.database) == ({"files"}, 0)
        return
    assert set(found.free) == {"database", "files"}
    assert all(free > 0 for free in found.free.values())
    assert found.database >= (tmp_path / "kinedex.sqlite3").stat().st_size > 0


@pytest.mark.slow
def test_a_large_library_is_counted_quickly(store: Store) -> None:
    now, problem = utc_now(), Unreadable("no motion").as_problem()
    common = {"created_at": now, "finished_at": now, "state": "succeeded"}
    rows = [
        {
            "id": f"job_{number}",
            "kind": "ingest",
            "priority": 1,
            "payload": {},
            "progress": 1.0,
            "error": problem if number % 100 == 0 else None,
            "attempts": 1,
            "max_attempts": 3,
            "cancel_requested": False,
            **common,
        }
        for number in range(100_000)
    ]
    clip = {"file_name": "a.bvh", "file_size": 1, "name": "a", "name_folded": "a"}
    clip_rows = [
        {
            "id": f"clip_{number}",
            "content_key": str(number),
            "sha256": str(number),
            "state": "failed" if number % 100 == 0 else "ready",
            "error": problem if number % 100 == 0 else None,
            "changed_version": number,
            "created_at": now,
            **clip,
        }
        for number in range(100_000)
    ]
    with store.write() as tx:
        tx.execute(insert(jobs_table), rows)
        tx.execute(insert(clips_table), clip_rows)
    census.count(store)  # statements are compiled once
    with cpu_seconds_below(0.2, "to count 100,000 jobs and 100,000 clips"):
        found = census.count(store)
    assert found.clips == {"ready": 99_000, "failed": 1_000}
