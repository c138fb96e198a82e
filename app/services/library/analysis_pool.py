"""Reading and analysing files where it can be killed (DESIGN 12).

A file from outside is parsed in a child process with a limit on time and memory, so that
hostile or monstrous content costs a failed clip and never the service.
"""

from __future__ import annotations

import concurrent.futures
import logging
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from app.deadline import result_of
from app.errors import (
    AnalysisCrashed,
    AnalysisInterrupted,
    AnalysisTimedOut,
    BadContent,
    ExtraNeeded,
    KinedexError,
    Place,
    StorageError,
    StoredFileMissing,
    TooLarge,
)
from app.logs import level_of_process
from app.services.children.child import ChildEnded
from app.services.children.pool import ChildPool, TaskTimedOut
from app.services.children.processes import limit_memory, log_like_parent, stderr_silenced
from app.store.files.checked import read_whole

if TYPE_CHECKING:
    from app.analysis.analyze import Analysis
    from app.analysis.rhythm.onsets import Onsets
    from app.motion.skeleton.recording import Caution, Recording

_log = logging.getLogger(__name__)
_Found = TypeVar("_Found")

TRIES = 2
"""Of an analysis that somebody waits for, where its process is killed from outside."""


@dataclass(frozen=True, slots=True)
class Order:
    """What to analyse: `content`, or the file at `path`; and what the client says of it.

    skeleton, skeleton_path: the ASF file of an AMC file, in the same way; stack: the animation
    stack of an FBX file; thresholds: T1 and T2 of keyposes, the usual ones where None; roles:
    joint names by role name; audio_path: a recording; beats, tempo, audio_offset: what the client
    says of the rhythm (seconds, beats a minute, seconds); for_search: leave out what only
    stored clips need.
    """

    content: bytes | None = None
    path: str | None = None
    skeleton: bytes | None = None
    skeleton_path: str | None = None
    stack: str | None = None
    thresholds: tuple[float, float] | None = None
    frame_rate: float | None = None
    metres_per_unit: float | None = None
    roles: Mapping[str, str] | None = None
    audio_path: str | None = None
    beats: tuple[float, ...] | None = None
    tempo: float | None = None
    audio_offset: float | None = None
    for_search: bool = False


@dataclass(frozen=True, slots=True)
class Limits:
    """What one analysis may take: seconds, MB of address space, frames, joints."""

    seconds: float
    memory_mb: int
    frames: int
    joints: int


class AnalysisPool:
    """Child processes that analyse files, `size` at a time; they start with the first order."""

    def __init__(self, limits: Limits, *, size: int = 1) -> None:
        self.limits = limits
        self._size = size
        self._lock = threading.Lock()
        self._pool = self._new_pool()

    def submit(
        self, order: Order, *, is_alone: bool = False
    ) -> concurrent.futures.Future[Analysis]:
        """Begin an analysis; `outcome` reads what came of it. Cancelling kills the child.

        is_alone: begin when no other analysis of this pool runs, and let none begin meanwhile.
        """
        return self._begin(analyze_order, order, is_alone=is_alone)

    def analyze(self, order: Order) -> Analysis:
        """Analyse and wait; raises as `outcome` does."""
        return self._wait_for(analyze_order, order)

    def read(self, order: Order) -> Recording:
        """Only read the file, and wait; raises as `outcome` does."""
        return self._wait_for(read_order, order)

    def _wait_for(self, work: Callable[[Order, Limits], _Found], order: Order) -> _Found:
        """Do it and wait; once more where the process was killed from outside."""
        for _ in range(TRIES - 1):
            try:
                return self.outcome(self._begin(work, order))
            except AnalysisInterrupted:
                _log.warning("an analysis process was killed; trying again")
        return self.outcome(self._begin(work, order))

    def _begin(
        self, work: Callable[[Order, Limits], _Found], order: Order, *, is_alone: bool = False
    ) -> concurrent.futures.Future[_Found]:
        with self._lock:
            return self._pool.submit(
                work, order, self.limits, seconds=self.limits.seconds, is_alone=is_alone
            )

    def outcome(self, future: concurrent.futures.Future[_Found]) -> _Found:
        """What a finished analysis, or reading, came to.

        Raises BadContent (or TooLarge) for what the content deserves: AnalysisTimedOut,
        AnalysisCrashed, and the reader's own failures; ChildDied where the child died by its
        own work, AnalysisInterrupted where it was killed from outside, StoredFileMissing or
        StorageError where the file cannot be read, CancelledError after `cancel`. Where the
        work at hand should not go on (ClientLeft, DeadlineExceeded) the child is killed.
        """
        try:
            return result_of(future)
        except KinedexError:
            raise
        except TaskTimedOut as late:
            raise AnalysisTimedOut(
                f"The analysis took longer than {self.limits.seconds:g} s and was stopped."
            ) from late
        except ChildEnded as end:
            raise end.as_failure() from end
        except MemoryError as hunger:
            raise AnalysisCrashed(
                f"The analysis needs more memory than its limit of {self.limits.memory_mb} MB."
            ) from hunger
        except FileNotFoundError as missing:
            raise StoredFileMissing() from missing
        except OSError as unreadable:
            raise StorageError("The stored file cannot be read.") from unreadable
        except Exception as surprise:
            # A defect of ours; the clip must still end, with something to report.
            _log.exception("analysis failed unexpectedly")
            raise AnalysisCrashed(
                f"The analysis failed unexpectedly ({type(surprise).__name__}); see the log."
            ) from surprise

    def rest(self) -> None:
        """Give back the memory of idle children; the next order starts new ones."""
        with self._lock:
            resting, self._pool = self._pool, self._new_pool()
        resting.close()

    def close(self) -> None:
        """Kill the children and wait for them."""
        self._pool.close()

    def _new_pool(self) -> ChildPool:
        return ChildPool(self._size, _prepare, self.limits.memory_mb, level_of_process())


def analyze_order(order: Order, limits: Limits) -> Analysis:
    """Read, canonicalize and analyse one file, here and now (runs in the child).

    Raises BadContent for what cannot be used, TooLarge beyond the limits.
    """
    from app.analysis import analyze
    from app.analysis.keyposes.keyposes import T1, T2
    from app.analysis.rhythm.rhythm import RhythmInput
    from app.motion.canonical.canonical import canonicalize
    from app.motion.roles.joint_roles import JointRole

    recording = read_order(order, limits)
    roles = {JointRole(role): joint for role, joint in (order.roles or {}).items()}
    motion = canonicalize(
        recording,
        frame_rate=order.frame_rate,
        metres_per_unit=order.metres_per_unit,
        roles=roles or None,
    )
    if order.for_search:
        return analyze.describe_for_search(motion)
    t1, t2 = order.thresholds or (T1, T2)
    given = RhythmInput(order.beats, order.tempo, order.audio_offset)
    onsets, doubts = (None, ()) if order.audio_path is None else _listen(Path(order.audio_path))
    found = analyze.analyze(motion, t1=t1, t2=t2, rhythm_input=given, onsets=onsets)
    return replace(found, cautions=(*doubts, *found.cautions))


def _listen(path: Path) -> tuple[Onsets | None, tuple[Caution, ...]]:
    """The onsets of a recording; none and why where it cannot be read, which stops no clip."""
    from app.analysis.rhythm.onsets import find_onsets
    from app.formats.audio.reader import read_audio
    from app.motion.skeleton.recording import Caution

    content = read_whole(path)
    try:
        with stderr_silenced():
            sound = read_audio(content)
        onsets = find_onsets(sound.samples, sound.rate)
    except ExtraNeeded as missing:
        return None, (Caution("audio_not_read", missing.detail),)
    except (BadContent, TooLarge) as problem:
        return None, (Caution("audio_unreadable", problem.detail),)
    except MemoryError:
        return None, (Caution("audio_unreadable", "The recording needs too much memory."),)
    if sound.missing is None:
        return onsets, ()
    detail = f"The recording is cut off: {sound.missing}, and only that is heard."
    return onsets, (Caution("audio_truncated", detail),)


def read_order(order: Order, limits: Limits) -> Recording:
    """Read one file, here and now (runs in the child).

    Raises BadContent for what cannot be read, TooLarge beyond the limits, FileDamaged.
    """
    from app.formats.read import read_recording

    content = order.content if order.content is not None else read_whole(Path(order.path or ""))
    skeleton = order.skeleton
    if order.skeleton_path is not None:
        skeleton = read_whole(Path(order.skeleton_path))
    recording = read_recording(content, skeleton, order.stack)
    _check_size(recording, limits)
    return recording


def _check_size(recording: Recording, limits: Limits) -> None:
    frames, joints = recording.positions.shape[:2]
    for noun, count, most in (("frames", frames, limits.frames), ("joints", joints, limits.joints)):
        if count > most:
            place = Place(noun, f"{count} {noun}, the limit is {most}")
            raise TooLarge(f"The motion has more than {most} {noun}.", places=[place])


def _prepare(memory_mb: int, level: str) -> None:
    """What each child does first."""
    log_like_parent(level)
    limit_memory(memory_mb)
