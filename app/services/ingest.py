"""From a stored file to a ready clip: what the analysis needs, and what becomes of it.

Everything that an analysis finds enters in one transaction with the clip's state, the
library's version, the job and the imports that wait: a clip is ready wholly or not at all.
"""

from __future__ import annotations

from app.analysis.analyse import ANALYSIS_VERSION, Analysis
from app.analysis.energy import EnergyMethod
from app.errors import MAX_MESSAGE, KinedexError, ModelNotFitted, StorageError, shortened
from app.services.analysis_pool import ChildDied, Order
from app.services.keypose_frames import named_keyposes
from app.services.library import Library
from app.services.stored_motion import motion_arrays
from app.store import clips as stored
from app.store import leases, outcomes
from app.store.clip_record import ClipFacts, ClipRecord, ClipWarning
from app.store.engine import Tx
from app.store.job_record import ClaimedJob

MOST_WARNINGS = 50
"""Of one clip."""
RETRY_DELAY_S = 5.0
"""Before a failure that may pass is tried again."""


def order_for(lib: Library, clip: ClipRecord) -> Order:
    """What to analyse for a clip. Raises NotFound where its file is gone."""
    skeleton, audio = clip.skeleton_sha256, clip.audio_sha256
    return Order(
        path=str(lib.store.files.path(clip.sha256)),
        skeleton_path=None if skeleton is None else str(lib.store.files.path(skeleton)),
        stack=clip.stack_override,
        frame_rate=clip.frame_rate_override,
        metres_per_unit=clip.metres_per_unit_override,
        roles=clip.roles_override,
        thresholds=_thresholds(lib),
        audio_path=None if audio is None else str(lib.store.files.path(audio)),
        beats=clip.beats_override,
        tempo=clip.tempo_override,
        audio_offset=clip.audio_offset_override,
    )


def _thresholds(lib: Library) -> tuple[float, float] | None:
    try:
        learned = lib.models.keyposes(lib.store).model.by_method.get(EnergyMethod.RMS)
    except ModelNotFitted:
        return None
    return None if learned is None else (learned.t1, learned.t2)


def finish(tx: Tx, claimed: ClaimedJob, clip: ClipRecord, found: Analysis) -> None:
    """Make the clip ready, unless it was changed meanwhile and waits for another analysis.

    `clip` is as it was when the analysis began. Imports that wait for it are the caller's to
    settle. Raises LeaseLost, ClipNotFound, StorageError.
    """
    if _is_superseded(tx, clip):
        _leave(tx, claimed, clip)
        return
    arrays = {**found.arrays, **motion_arrays(found.motion), **named_keyposes(tx, clip, found)}
    outcomes.finish_ingest(tx, claimed.lease, clip.id, facts(found), arrays, settles_imports=False)


def fail(
    tx: Tx, claimed: ClaimedJob, clip: ClipRecord, problem: KinedexError, max_attempts: int
) -> None:
    """Fail the clip for its own reason; only what may pass is tried again. Raises LeaseLost."""
    if _is_superseded(tx, clip):
        _leave(tx, claimed, clip)
    elif _may_pass(problem) and claimed.lease.attempt < max_attempts:
        outcomes.retry_or_fail(tx, claimed, problem.as_problem(), delay_s=RETRY_DELAY_S)
    else:
        outcomes.fail_job(tx, claimed, problem.as_problem())


def facts(found: Analysis) -> ClipFacts:
    """What a clip's row tells of its motion."""
    motion = found.motion
    doubts = (*motion.cautions, *found.cautions)
    return ClipFacts(
        format=motion.format,
        frames=motion.frames,
        frame_rate=motion.frame_rate,
        declared_frame_rate=motion.declared_frame_rate,
        duration=motion.duration,
        joints=len(motion.names),
        metres_per_unit=motion.metres_per_unit,
        roles={role.value: motion.names[joint] for role, joint in motion.roles.items()},
        missing_roles=tuple(role.value for role in motion.missing_roles),
        warnings=tuple(
            ClipWarning(c.code, shortened(c.detail, MAX_MESSAGE), c.likely)
            for c in doubts[:MOST_WARNINGS]
        ),
        analysis_version=ANALYSIS_VERSION,
        audio_offset=found.audio_offset,
    )


def _is_superseded(tx: Tx, clip: ClipRecord) -> bool:
    """Whether what the client says of the file has changed since the analysis began."""
    return stored.overrides(tx, clip.id) != clip.overrides


def _leave(tx: Tx, claimed: ClaimedJob, clip: ClipRecord) -> None:
    """Leave the clip to the job that was queued when it was changed."""
    leases.succeed(tx, claimed.lease, {"clip_id": clip.id, "superseded": True})


def _may_pass(problem: KinedexError) -> bool:
    """Whether trying again could help: a child that was killed, a store that failed."""
    return isinstance(problem, ChildDied | StorageError)
