"""A ready clip keeps its analysis until another one replaces it."""

from __future__ import annotations

import numpy as np
import pytest

from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.record import ClipRecord, ClipState, Reanalysis
from app.store.database.engine import Tx
from app.store.jobs import outcomes
from app.store.jobs import repository as jobs
from app.store.jobs.record import ClaimedJob, JobKind, JobState, NewJob
from app.store.store import Store
from tests.store.conftest import facts
from tests.store.queued import FOUND, PROBLEM, add, die, take


def make_ready(tx: Tx, name: str) -> ClipRecord:
    clip = add(tx, name)
    outcomes.finish_ingest(tx, take(tx).lease, clip.id, facts(), FOUND)
    return clip


def analyze_again(tx: Tx, clip: ClipRecord) -> ClaimedJob:
    """The clip waits for another analysis, and a worker takes it."""
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id, max_attempts=2))
    waiting = clips.requeue(tx, clip.id)
    assert (waiting.state, waiting.reanalysis) == (ClipState.READY, Reanalysis.QUEUED)
    return take(tx)


def test_a_ready_clip_stays_ready_until_another_analysis_replaces_the_first(store: Store) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        before = library.version(tx)
        claimed = analyze_again(tx, clip)
        worked_on = clips.get(tx, clip.id)
        assert (worked_on.state, worked_on.reanalysis) == (ClipState.READY, Reanalysis.PROCESSING)
        assert library.version(tx) == before  # nothing that a search could see has changed
        outcomes.give_back(tx, claimed)
        assert clips.get(tx, clip.id).reanalysis is Reanalysis.QUEUED
        anew = {"motion_vector": np.zeros(128, np.float32)}
        outcomes.finish_ingest(tx, take(tx).lease, clip.id, facts(frames=7), anew)
        done = clips.get(tx, clip.id)
        assert (done.state, done.reanalysis, done.frames) == (ClipState.READY, None, 7)
        assert not arrays.get_one(tx, clip.id, "motion_vector").any()


MISSING = {"code": "file_missing", "detail": "The stored motion file is missing"}


@pytest.mark.parametrize(
    ("problem", "is_verdict", "is_changed", "state", "code"),
    [
        (PROBLEM, True, False, ClipState.READY, "reanalysis_failed"),
        (PROBLEM, True, True, ClipState.FAILED, None),
        (PROBLEM, False, True, ClipState.READY, "reanalysis_failed"),
        (MISSING, False, True, ClipState.READY, "file_missing"),
    ],
)
def test_only_bad_content_after_a_change_makes_a_ready_clip_failed(
    store: Store,
    problem: dict[str, str],
    is_verdict: bool,
    is_changed: bool,
    state: ClipState,
    code: str | None,
) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        if is_changed:
            clips.patch(tx, clip.id, {"frame_rate": 12.0})
        claimed = analyze_again(tx, clip)
        outcomes.fail_job(tx, claimed, problem, is_verdict=is_verdict)
        found = clips.get(tx, clip.id)
        assert (found.state, jobs.get(tx, claimed.job.id).state) == (state, JobState.FAILED)
        details = {warning.code: warning.detail for warning in found.warnings}
        assert (code is None) == (found.reanalysis is None)
        if code is not None:
            assert found.reanalysis is Reanalysis.FAILED
            assert problem["detail"] in details[code]
            assert arrays.get_one(tx, clip.id, "motion_vector").all()
        # A successful analysis removes the warning.
        outcomes.finish_ingest(tx, analyze_again_whatever(tx, clip).lease, clip.id, facts(), FOUND)
        healed = clips.get(tx, clip.id)
        assert (healed.state, healed.reanalysis) == (ClipState.READY, None)
        assert code not in {warning.code for warning in healed.warnings}


def analyze_again_whatever(tx: Tx, clip: ClipRecord) -> ClaimedJob:
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id))
    clips.requeue(tx, clip.id)
    return take(tx)


def test_a_ready_clip_survives_dead_workers_and_a_cancellation(store: Store) -> None:
    with store.write() as tx:
        clip = make_ready(tx, "walk")
        analyze_again(tx, clip)
        die(tx)
        assert clips.get(tx, clip.id).reanalysis is Reanalysis.QUEUED
        claimed = take(tx)
        die(tx)
        assert jobs.get(tx, claimed.job.id).state is JobState.FAILED
        found = clips.get(tx, clip.id)
        assert (found.state, found.reanalysis) == (ClipState.READY, Reanalysis.FAILED)
        again = analyze_again(tx, clip)
        outcomes.finish_canceled(tx, again)
        assert clips.get(tx, clip.id).state is ClipState.READY
