"""Which stored files are still needed."""

from __future__ import annotations

from collections.abc import Collection

from sqlalchemy import select, union

from app.store import library
from app.store.clips import in_batches
from app.store.engine import Tx
from app.store.job_record import OPEN_STATES
from app.store.tables import clips, jobs


def unreferenced(tx: Tx, sha256s: Collection[str]) -> tuple[str, ...]:
    """Those of the files that no clip and no open job refers to, in the order given."""
    library.lock(tx)
    needed: set[str] = set()
    for batch in in_batches(sha256s):
        needed.update(_needed(tx, batch))
    return tuple(sha256 for sha256 in dict.fromkeys(sha256s) if sha256 not in needed)


def _needed(tx: Tx, batch: list[str]) -> set[str]:
    of_open_jobs = jobs.c.state.in_([state.value for state in OPEN_STATES])
    every = union(
        select(clips.c.sha256).where(clips.c.sha256.in_(batch)),
        select(clips.c.skeleton_sha256).where(clips.c.skeleton_sha256.in_(batch)),
        select(clips.c.audio_sha256).where(clips.c.audio_sha256.in_(batch)),
        select(jobs.c.file_sha256).where(jobs.c.file_sha256.in_(batch), of_open_jobs),
    )
    return set(tx.execute(every).scalars())
