"""Clips with ingest jobs, which workers claim and which may lose their worker."""

from __future__ import annotations

import numpy as np

from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord, ClipState
from app.store.database.engine import Tx
from app.store.jobs import queue
from app.store.jobs import repository as jobs
from app.store.jobs.abandoned_jobs import Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobState, NewJob
from tests.store.conftest import new_clip

ALL = tuple(JobKind)
PROBLEM = {"code": "unreadable", "detail": "line 3"}
FOUND = {"motion_vector": np.ones(128, np.float32)}


def add(tx: Tx, name: str, **job: int) -> ClipRecord:
    """A clip with its ingest job, as an upload makes them."""
    clip = clips.add_or_get(tx, new_clip(name)).clip
    jobs.enqueue(tx, NewJob(JobKind.INGEST, clip_id=clip.id, **job))
    return clip


def take(tx: Tx) -> ClaimedJob:
    claimed = queue.take(tx, ALL, "worker")
    assert claimed is not None
    return claimed


def die(tx: Tx) -> None:
    """The workers of all claimed jobs die, and another worker recovers the jobs."""
    watch = Watch("watcher", 0.0)
    queue.recover(tx, watch, watch.look(tx))


def states(tx: Tx, clip: ClipRecord, claimed: ClaimedJob) -> tuple[ClipState, JobState]:
    return clips.get(tx, clip.id).state, jobs.get(tx, claimed.job.id).state
