"""Reading and analyzing files in processes that can be killed.

A file from outside is parsed in a child process with a limit on time and memory, so that
hostile or huge content makes one clip fail and never stops the service. The child can do nothing
else (`app.services.children.sandbox`): the parent opens the files for it.
"""

from __future__ import annotations

import concurrent.futures
import logging
import threading
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from app.deadline import result_of
from app.errors import (
    AnalysisCrashed,
    AnalysisInterrupted,
    AnalysisTimedOut,
    BadContent,
    ExtraNeeded,
    StorageError,
    StoredFileMissing,
    TooLarge,
)
from app.kinedex_error import KinedexError, Place
from app.logs import level_of_process
from app.services.children.child import ChildEnded
from app.services.children.given_files import open_given
from app.services.children.pool import ChildPool, TaskTimedOut
from app.services.children.processes import log_like_parent, stderr_silenced
from app.services.children.sandbox import Sandbox, status
from app.services.library.compiled_code import compiled_code
from app.store.files.hash_check import read_whole

if TYPE_CHECKING:
    from app.analysis.analyze import Analysis
    from app.analysis.rhythm.onsets import Onsets
    from app.motion.skeleton.recording import Caution, Recording

_log = logging.getLogger(__name__)
_Result = TypeVar("_Result")

TRIES = 2
"""How often an analysis that somebody waits for is tried if its process is killed from outside."""


@dataclass(frozen=True, slots=True)
class AnalysisRequest:
    """What to analyze: `content`, or the file at `path`; with the client's hints.

    skeleton, skeleton_path: content or path of the ASF file that an AMC file needs; stack: the
    animation stack of an FBX file; thresholds: T1 and T2 of keyposes, None for the default ones;
    frame_rate: Hz; up_axis: of the file; roles: joint names by role name; audio_path: a recording
    of sound; beats, tempo, audio_offset: the rhythm as the client gives it (seconds, beats a
    minute, seconds); for_search: compute only what searches need.
    """

    content: bytes | None = None
    path: str | None = None
    skeleton: bytes | None = None
    skeleton_path: str | None = None
    stack: str | None = None
    thresholds: tuple[float, float] | None = None
    frame_rate: float | None = None
    metres_per_unit: float | None = None
    up_axis: str | None = None
    roles: Mapping[str, str | list[str]] | None = None
    audio_path: str | None = None
    beats: tuple[float, ...] | None = None
    tempo: float | None = None
    audio_offset: float | None = None
    for_search: bool = False

    def files(self) -> tuple[str, ...]:
        """The paths of its files, each once."""
        paths = (self.path, self.skeleton_path, self.audio_path)
        return tuple(dict.fromkeys(path for path in paths if path is not None))


@dataclass(frozen=True, slots=True)
class Limits:
    """Upper limits of one analysis: seconds, MB of address space, frames, joints."""

    seconds: float
    memory_mb: int
    frames: int
    joints: int


class AnalysisPool:
    """Child processes that analyze files, `size` at a time; they start with the first request."""

    def __init__(self, limits: Limits, *, size: int = 1, cache: Path | None = None) -> None:
        """cache: a folder for code that libraries compile, unless NUMBA_CACHE_DIR names one."""
        self.limits = limits
        self._sandbox = Sandbox.of_this_program(cache)
        self._has_folders = False
        _warn_if_open()
        self._size = size
        self._lock = threading.Lock()
        self._pool = self._new_pool()

    def submit(
        self, request: AnalysisRequest, *, is_alone: bool = False
    ) -> concurrent.futures.Future[Analysis]:
        """Begin an analysis; `outcome` returns its result. Canceling the future kills the child.

        is_alone: wait until no other analysis of this pool runs, and let none begin meanwhile.
        """
        return self._begin(analyze_file, request, is_alone=is_alone)

    def analyze(self, request: AnalysisRequest) -> Analysis:
        """Analyze and wait; raises as `outcome` does."""
        return self._wait_for(analyze_file, request)

    def read(self, request: AnalysisRequest) -> Recording:
        """Only read the file, and wait; raises as `outcome` does."""
        return self._wait_for(read_file, request)

    def _wait_for(
        self, work: Callable[[AnalysisRequest, Limits], _Result], request: AnalysisRequest
    ) -> _Result:
        """Do the work and wait; try again if the process was killed from outside."""
        for _ in range(TRIES - 1):
            try:
                return self.outcome(self._begin(work, request))
            except AnalysisInterrupted:
                _log.warning("an analysis process was killed; trying again")
        return self.outcome(self._begin(work, request))

    def _begin(
        self,
        work: Callable[[AnalysisRequest, Limits], _Result],
        request: AnalysisRequest,
        *,
        is_alone: bool = False,
    ) -> concurrent.futures.Future[_Result]:
        with self._lock:
            if not self._has_folders:
                self._sandbox.make_folders()
                self._has_folders = True
            return self._pool.submit(
                work,
                request,
                self.limits,
                seconds=self.limits.seconds,
                is_alone=is_alone,
                files=request.files(),
            )

    def outcome(self, future: concurrent.futures.Future[_Result]) -> _Result:
        """The result of an analysis, or of reading a file; waits for it.

        Raises BadContent (or TooLarge) if the content is at fault: AnalysisTimedOut,
        AnalysisCrashed, and the failures of the readers; ChildDied if the child died by its
        own work; AnalysisInterrupted if it was killed from outside; StoredFileMissing or
        StorageError if the file cannot be read; CancelledError after `cancel`. If the caller's
        own work must stop (ClientLeft, DeadlineExceeded), the child is killed.
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
            # A defect of Kinedex. The clip must still fail, with a message.
            _log.exception("analysis failed unexpectedly")
            raise AnalysisCrashed(
                f"The analysis failed unexpectedly ({type(surprise).__name__}); see the log."
            ) from surprise

    def rest(self) -> None:
        """Free the memory of idle children; the next request starts new ones."""
        with self._lock:
            resting, self._pool = self._pool, self._new_pool()
        resting.close()

    def close(self) -> None:
        """Kill the children and wait for them."""
        self._pool.close()

    def _new_pool(self) -> ChildPool:
        level, memory_mb = level_of_process(), self.limits.memory_mb
        return ChildPool(self._size, _prepare, self._sandbox, memory_mb, level)


def analyze_file(request: AnalysisRequest, limits: Limits) -> Analysis:
    """Read one file, make it canonical and analyze it, in this process (the child).

    Raises BadContent for content that cannot be used, TooLarge beyond the limits.
    """
    from app.analysis import analyze
    from app.analysis.keyposes.keyposes import T1, T2
    from app.analysis.rhythm.rhythm import RhythmInput
    from app.analysis.stage_times import StageTimes
    from app.motion.canonical.canonical import canonicalize
    from app.motion.roles.joint_roles import JointRole

    times = StageTimes()
    with times.stage("read"):
        recording = read_file(request, limits)
    roles = {JointRole(role): joint for role, joint in (request.roles or {}).items()}
    with times.stage("canonicalize"):
        motion = canonicalize(
            recording,
            frame_rate=request.frame_rate,
            metres_per_unit=request.metres_per_unit,
            up_axis=request.up_axis,
            roles=roles or None,
        )
    if request.for_search:
        return analyze.describe_for_search(motion)
    t1, t2 = request.thresholds or (T1, T2)
    given = RhythmInput(request.beats, request.tempo, request.audio_offset)
    with nullcontext() if request.audio_path is None else compiled_code():
        with times.stage("listen"):
            onsets, doubts = _onsets(request.audio_path)
        found = analyze.analyze(
            motion, t1=t1, t2=t2, rhythm_input=given, onsets=onsets, times=times
        )
    return replace(found, cautions=(*doubts, *found.cautions))


def _onsets(audio_path: str | None) -> tuple[Onsets | None, tuple[Caution, ...]]:
    return (None, ()) if audio_path is None else _listen(audio_path)


def _listen(path: str) -> tuple[Onsets | None, tuple[Caution, ...]]:
    """The onsets of a recording, and cautions.

    A recording that cannot be read gives None and a caution: it must not make the clip fail.
    """
    from app.analysis.rhythm.onsets import find_onsets
    from app.formats.audio.reader import read_audio
    from app.motion.skeleton.recording import Caution

    content = _read(path)
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
    detail = f"The recording is cut off: {sound.missing}, and only that part is used."
    return onsets, (Caution("audio_truncated", detail),)


def read_file(request: AnalysisRequest, limits: Limits) -> Recording:
    """Read one file in this process (the child).

    Raises BadContent for content that cannot be read, TooLarge beyond the limits, FileDamaged.
    """
    from app.formats.read import read_recording

    content = request.content
    if content is None:
        content = _read(request.path or "")
    skeleton = request.skeleton
    if request.skeleton_path is not None:
        skeleton = _read(request.skeleton_path)
    recording = read_recording(content, skeleton, request.stack)
    _check_size(recording, limits)
    return recording


def _read(path: str) -> bytes:
    with open_given(path) as file:
        return read_whole(file, Path(path).name)


def _check_size(recording: Recording, limits: Limits) -> None:
    frames, joints = recording.positions.shape[:2]
    for noun, count, limit in (
        ("frames", frames, limits.frames),
        ("joints", joints, limits.joints),
    ):
        if count > limit:
            place = Place(noun, f"{count} {noun}, the limit is {limit}")
            raise TooLarge(f"The motion has more than {limit} {noun}.", places=[place])


def _prepare(sandbox: Sandbox, memory_mb: int, level: str) -> None:
    """Set up a child process before its first task."""
    log_like_parent(level)
    sandbox.enter(memory_mb)


@cache
def _warn_if_open() -> None:
    missing = status().missing
    if missing:
        _log.warning("this kernel does not keep analysis processes from %s", ", ".join(missing))
