"""From a stored file to a ready clip: what an analysis needs, and how its result is stored.

One transaction stores everything that an analysis finds, the clip's state, the library's version,
the job and the imports that wait: a clip is never ready in part.
"""

from __future__ import annotations

from dataclasses import asdict, astuple

from app.analysis.analyze import ANALYSIS_VERSION, Analysis
from app.errors import (
    AnalysisCrashed,
    AnalysisInterrupted,
    AnalysisTimedOut,
    BadContent,
    NotFound,
    StorageError,
    StoredFileMissing,
    TooLarge,
)
from app.kinedex_error import MAX_MESSAGE, KinedexError, shortened
from app.models.keyposes.thresholds import Thresholds
from app.motion.motion import Motion
from app.motion.skeleton.recording import Caution
from app.services.children.child import ChildDied
from app.services.library.analysis_pool import AnalysisRequest
from app.services.library.keypose_frames import annotated_keypose_arrays
from app.services.library.keypose_thresholds import library_thresholds
from app.services.library.library import Library
from app.services.library.stored_motion import motion_arrays
from app.store import stage_times
from app.store.clips import quality
from app.store.clips import repository as stored
from app.store.clips.record import ClipFacts, ClipRecord, ClipWarning
from app.store.database.engine import Tx
from app.store.jobs import leases, outcomes
from app.store.jobs.record import ClaimedJob

MAX_WARNINGS = 50
"""Largest number of warnings that are stored for one clip."""
RETRY_DELAY_S = 5.0
"""How long to wait before a temporary failure is tried again."""


def analysis_request(
    lib: Library, clip: ClipRecord, thresholds: Thresholds | None = None
) -> AnalysisRequest:
    """The analysis of a stored clip. Raises StoredFileMissing if one of its files is gone.

    thresholds: of its keyposes, by default those of the library, for which the store is asked.
    """
    skeleton, audio, hints = clip.skeleton_sha256, clip.audio_sha256, clip.hints
    return AnalysisRequest(
        path=_place(lib, clip.sha256, "motion file"),
        skeleton_path=None if skeleton is None else _place(lib, skeleton, "skeleton file"),
        stack=hints.stack,
        frame_rate=hints.frame_rate,
        metres_per_unit=hints.metres_per_unit,
        up_axis=hints.up_axis,
        roles=hints.roles,
        thresholds=astuple(thresholds or library_thresholds(lib)),
        audio_path=None if audio is None else _place(lib, audio, "recording"),
        beats=hints.beats,
        tempo=hints.tempo,
        audio_offset=hints.audio_offset,
    )


def _place(lib: Library, sha256: str, what: str) -> str:
    try:
        return str(lib.store.files.path(sha256))
    except NotFound as missing:
        message = f"The stored {what} of this clip is missing ({sha256})"
        raise StoredFileMissing(message) from missing


def finish(tx: Tx, claimed: ClaimedJob, clip: ClipRecord, analysis: Analysis) -> None:
    """Make the clip ready, unless it was changed meanwhile and waits for another analysis.

    clip: its record at the start of the analysis. The caller must settle the imports that wait for
    the clip. Raises LeaseLost, ClipNotFound, StorageError.
    """
    if _is_superseded(tx, clip):
        _leave(tx, claimed, clip)
        return
    arrays = {
        **analysis.arrays,
        **motion_arrays(analysis.motion),
        **annotated_keypose_arrays(tx, clip, analysis),
    }
    outcomes.finish_ingest(
        tx, claimed.lease, clip.id, facts(analysis), arrays, settles_imports=False
    )
    if analysis.quality is not None:
        quality.put(tx, clip.id, analysis.quality)
    stage_times.add(tx, analysis.stage_seconds)


def fail(
    tx: Tx, claimed: ClaimedJob, clip: ClipRecord, problem: KinedexError, max_failures: int
) -> None:
    """Fail the clip, or queue its analysis again if the problem may be temporary.

    A child that was killed from outside is not a failure of the clip. Raises LeaseLost.
    """
    if _is_superseded(tx, clip):
        _leave(tx, claimed, clip)
    elif isinstance(problem, AnalysisInterrupted):
        outcomes.retry_after_kill(tx, claimed, _always_killed(problem).as_problem())
    elif isinstance(problem, ChildDied | StorageError):
        outcomes.retry_or_fail(
            tx, claimed, problem.as_problem(), delay_s=RETRY_DELAY_S, max_failures=max_failures
        )
    else:
        outcomes.fail_job(tx, claimed, problem.as_problem(), is_verdict=_is_verdict(problem))


def _always_killed(problem: KinedexError) -> KinedexError:
    """The final error of a clip, if every try of its analysis was killed from outside."""
    return AnalysisCrashed(
        f"{problem.detail} This happened {outcomes.MAX_KILLS + 1} times, the last time while no"
        " other file was analyzed here. Find out what stops the process (often a limit on"
        " memory), then send the file again or run `kinedex reanalyze --failed`."
    )


def _is_verdict(problem: KinedexError) -> bool:
    """Whether a reader refused the content, so that another try would give the same error."""
    # A crash and a timeout may depend on the load of the machine.
    is_machine = isinstance(problem, AnalysisCrashed | AnalysisTimedOut)
    return isinstance(problem, BadContent | TooLarge) and not is_machine


def facts(analysis: Analysis) -> ClipFacts:
    """The results of an analysis that are columns of the clip's row."""
    motion = analysis.motion
    cautions = (*motion.cautions, *analysis.cautions)
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
        warnings=tuple(_warning(caution, motion) for caution in cautions[:MAX_WARNINGS]),
        analysis_version=ANALYSIS_VERSION,
        audio_offset=analysis.audio_offset,
        start_offset=motion.start_offset,
        **({} if analysis.measures is None else asdict(analysis.measures)),
    )


def _warning(caution: Caution, motion: Motion) -> ClipWarning:
    """The warning of a caution; its frames become times of the clip in seconds."""
    start = end = None
    if caution.frames is not None:
        first, after = caution.frames
        start, end = first / motion.frame_rate, (after - 1) / motion.frame_rate
    detail = shortened(caution.detail, MAX_MESSAGE)
    return ClipWarning(caution.code, detail, caution.likely, start, end, caution.joint)


def _is_superseded(tx: Tx, clip: ClipRecord) -> bool:
    """Whether the client changed a hint or the recording since the analysis began."""
    return stored.analysis_input(tx, clip.id) != clip.analysis_input


def _leave(tx: Tx, claimed: ClaimedJob, clip: ClipRecord) -> None:
    """Drop this analysis: the change of the clip has queued another job."""
    leases.succeed(tx, claimed.lease, {"clip_id": clip.id, "superseded": True})
