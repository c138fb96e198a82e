"""The values that make up a clip in the store: labels, hints, recording, and the whole record."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any


class ClipState(StrEnum):
    """The state of a clip."""

    QUEUED = "queued"
    """Stored durably; waits for a worker."""
    PROCESSING = "processing"
    """A worker analyzes it."""
    READY = "ready"
    """Analyzed: the next search finds it."""
    FAILED = "failed"
    """Cannot be analyzed; `error` says why. It is listed and never searched."""


class Reanalysis(StrEnum):
    """The state of another analysis of a ready clip."""

    QUEUED = "queued"
    """It waits for a worker."""
    PROCESSING = "processing"
    """A worker is at it."""
    FAILED = "failed"
    """It failed: a warning says why."""


REANALYSIS_OPEN = (Reanalysis.QUEUED, Reanalysis.PROCESSING)


@dataclass(frozen=True, slots=True)
class ClipWarning:
    """A doubt about a clip: `code` for machines, `detail` for people, `likely`: a better value."""

    code: str
    detail: str
    likely: float | None = None


@dataclass(frozen=True, slots=True)
class ClipLabels:
    """What people call a clip and say about it; searches filter by these.

    words: in lower case, each once; the store's callers tidy all of them. A label that is added
    here needs a column of the same name in the table `clips` (words have a table of their own).
    """

    name: str
    person: str | None = None
    task: str | None = None
    words: tuple[str, ...] = ()
    license: str | None = None
    source: str | None = None


@dataclass(frozen=True, slots=True)
class AnalysisHints:
    """What a client says about a motion file: it goes before what the file says.

    frame_rate: Hz; metres_per_unit: of the file's coordinates; up_axis: "y", "-z", ...; roles:
    joint name by role, or two names for the middle of both; stack: name of an FBX file's animation
    stack; audio_offset: seconds of the motion at which the recording begins; tempo: beats a minute;
    beats: seconds. The column of a hint in the table `clips` has its name and `_override`.
    """

    frame_rate: float | None = None
    metres_per_unit: float | None = None
    up_axis: str | None = None
    roles: dict[str, str | list[str]] | None = None
    stack: str | None = None
    audio_offset: float | None = None
    tempo: float | None = None
    beats: tuple[float, ...] | None = None


AUDIO_HINTS = ("audio_offset", "tempo", "beats")
"""The hints about a recording. They are replaced together with it."""


@dataclass(frozen=True, slots=True)
class AttachedAudio:
    """The recording that goes with a motion: SHA-256 of its bytes, file name, size in bytes.

    The columns in the table `clips` begin with `audio_`.
    """

    sha256: str
    name: str = "audio"
    size: int = 0


AnalysisInput = tuple[AnalysisHints, str | None]
"""What an analysis depends on besides the motion file: the hints, the recording's SHA-256."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClipRecord(ClipLabels):
    """A clip's row with its labels. What the analysis finds is None (or empty) until it is ready.

    sha256: of the file's own bytes; content_key: makes the clip one of a kind (the same as
    sha256, or with a skeleton companion a hash of both); roles: joint name by role; durations in
    seconds, rates in Hz; error: an RFC 9457 problem; audio_offset: the time of the motion (s) at
    which the analysis says that the recording begins, if known; reanalysis: where another
    analysis of a ready clip stands, None where none is to come; is_changed: whether a client has
    changed the hints or the recording since the analysis; changed_version: library version of
    the last change that searches see, 0 while the clip was never searchable.
    """

    id: str
    state: ClipState
    format: str | None
    sha256: str
    frames: int | None
    frame_rate: float | None
    declared_frame_rate: float | None
    duration: float | None
    joints: int | None
    roles: dict[str, str]
    missing_roles: tuple[str, ...]
    warnings: tuple[ClipWarning, ...]
    created_at: datetime
    error: dict[str, Any] | None
    metres_per_unit: float | None
    content_key: str
    file_name: str
    file_size: int
    skeleton_sha256: str | None
    hints: AnalysisHints
    audio: AttachedAudio | None
    audio_offset: float | None
    analysis_version: int | None
    reanalysis: Reanalysis | None
    is_changed: bool
    changed_version: int

    @property
    def audio_sha256(self) -> str | None:
        """SHA-256 of the recording, None where there is none."""
        return None if self.audio is None else self.audio.sha256

    @property
    def has_audio(self) -> bool:
        """Whether a recording goes with the motion."""
        return self.audio is not None

    @property
    def audio_begins_at(self) -> float | None:
        """Seconds of the motion at which the recording begins: as the client says, otherwise as
        the analysis estimates; None without a recording."""
        if self.audio is None:
            return None
        said = self.hints.audio_offset
        return self.audio_offset if said is None else said

    @property
    def analysis_input(self) -> AnalysisInput:
        """The hints and the recording, on which the analysis depends."""
        return self.hints, self.audio_sha256

    @property
    def is_settled(self) -> bool:
        """Whether no analysis of the clip is waiting or running."""
        is_done = self.state in (ClipState.READY, ClipState.FAILED)
        return is_done and self.reanalysis not in REANALYSIS_OPEN


@dataclass(frozen=True, slots=True)
class NewClip:
    """What is known of a clip before its analysis; the caller has tidied the labels."""

    sha256: str
    file_name: str
    file_size: int
    labels: ClipLabels
    hints: AnalysisHints = AnalysisHints()
    skeleton_sha256: str | None = None
    audio: AttachedAudio | None = None

    @property
    def content_key(self) -> str:
        """Hex SHA-256 that two clips share only if file and skeleton companion are the same."""
        if self.skeleton_sha256 is None:
            return self.sha256
        return hashlib.sha256(f"{self.sha256}+{self.skeleton_sha256}".encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class ClipFacts:
    """What the analysis found out about a clip; units as in ClipRecord."""

    format: str
    frames: int
    frame_rate: float
    declared_frame_rate: float | None
    duration: float
    joints: int
    metres_per_unit: float
    roles: dict[str, str]
    missing_roles: tuple[str, ...]
    warnings: tuple[ClipWarning, ...]
    analysis_version: int
    audio_offset: float | None = None


ClipChanges = Mapping[str, Any]
"""New values of some fields of ClipLabels and AnalysisHints, and of `audio` (AttachedAudio or
None), by their names; a field that is absent keeps its value."""


class AddOutcome(StrEnum):
    """What `add_or_get` did with new content."""

    ADDED = "added"
    """A new clip: it needs an ingest job."""
    EXISTS = "exists"
    """The same content is there already; nothing was changed."""
    REQUEUED = "requeued"
    """The same content had failed, or comes with another recording; it is queued again and
    needs an ingest job."""


@dataclass(frozen=True, slots=True)
class Added:
    """The answer to `clips.add_or_get`."""

    clip: ClipRecord
    outcome: AddOutcome
    replaced_audio: str | None = None
    """SHA-256 of a recording that the clip no longer refers to."""

    @property
    def needs_analysis(self) -> bool:
        """Whether the caller has to enqueue an ingest job in the same transaction."""
        return self.outcome is not AddOutcome.EXISTS
