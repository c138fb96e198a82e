"""The data of a clip in the store: labels, hints, recording, and the whole record."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any

from app.store.clips.metadata_values import Metadata


class ClipState(StrEnum):
    """The state of a clip."""

    QUEUED = "queued"
    """The clip is stored durably and waits for a worker."""
    PROCESSING = "processing"
    """A worker analyzes the clip."""
    READY = "ready"
    """The clip is analyzed: the next search finds it."""
    FAILED = "failed"
    """The clip cannot be analyzed; `error` says why. Lists show it, searches never find it."""


class Reanalysis(StrEnum):
    """The state of another analysis of a ready clip."""

    QUEUED = "queued"
    """The analysis waits for a worker."""
    PROCESSING = "processing"
    """A worker does the analysis."""
    FAILED = "failed"
    """The analysis failed: a warning says why."""


REANALYSIS_OPEN = (Reanalysis.QUEUED, Reanalysis.PROCESSING)


@dataclass(frozen=True, slots=True)
class ClipWarning:
    """A doubt about a clip.

    code: for programs; detail: for people; likely: a more probable value of the doubtful number;
    start, end: the times of the first and the last doubtful frame, seconds of the clip; joint: the
    doubtful joint, by its name in the file. They are None where the doubt has no such place.
    """

    code: str
    detail: str
    likely: float | None = None
    start: float | None = None
    end: float | None = None
    joint: str | None = None


@dataclass(frozen=True, slots=True)
class ClipLabels:
    """The name of a clip and what people say about it; searches filter by these labels.

    words: in lower case, without repetition. The callers of the store normalize all labels. A new
    field here needs a column of the same name in the table `clips` (words, metadata and captions
    have their own tables). metadata: free values by key. captions: sentences that describe the
    motion.
    """

    name: str
    person: str | None = None
    task: str | None = None
    words: tuple[str, ...] = ()
    license: str | None = None
    source: str | None = None
    metadata: Metadata = field(default_factory=dict)
    captions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AnalysisHints:
    """Facts about a motion file that a client states; they override those in the file.

    frame_rate: Hz; metres_per_unit: of the coordinates in the file; up_axis: "y", "-z", ...;
    roles: joint name by role, or two names for the middle of both; stack: name of the animation
    stack in an FBX file; audio_offset: time of the motion at which the recording begins, seconds;
    tempo: beats per minute; beats: seconds. The column of a hint in the table `clips` is its name
    with `_override` added.
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
"""The hints about a recording. A new recording replaces them too."""


@dataclass(frozen=True, slots=True)
class AttachedAudio:
    """The audio recording of a motion: SHA-256 of its bytes, file name, size in bytes.

    The columns in the table `clips` begin with `audio_`.
    """

    sha256: str
    name: str = "audio"
    size: int = 0


META = "meta."
"""Begins the name of one key of the metadata, where labels are named one by one."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A label, hint or key of the metadata (`meta.KEY`) that came with content that is stored.

    stored: the value in the library before; sent: the other value that came now; None is no value;
    applied: whether `sent` has replaced `stored`.
    """

    field: str
    stored: Any
    sent: Any
    applied: bool


@dataclass(frozen=True, slots=True)
class ClipOrigin:
    """Where an edited copy comes from.

    clip_id: of the original; steps: the edits, in their order, each as an object with its `kind`;
    is_deleted: whether the original was deleted since.
    """

    clip_id: str
    steps: tuple[dict[str, Any], ...]
    is_deleted: bool = False


AnalysisInput = tuple[AnalysisHints, str | None]
"""The input of an analysis besides the motion file: the hints, and the recording's SHA-256."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClipRecord(ClipLabels):
    """The row of a clip with its labels.

    The results of the analysis are None (or empty) until the clip is ready.

    path: where the file was, relative to its import, with /; None if it came without a path;
    imported: the labels and hints that came with the file last, by name (`meta.KEY` for a key of
    the metadata): a label with another value was edited since.
    sha256: of the bytes of the motion file; content_key: unique for each content (sha256, or with
    a skeleton file a hash of both); roles: joint name by role; durations in seconds, rates in Hz;
    error: an RFC 9457 problem; audio_offset: the time of the motion (s) at which the recording
    begins, as the analysis estimates it; travel, speed, energy, tempo: see `measures.FOUND`;
    start_offset: seconds from the start of the motion file to the clip's first frame; reanalysis:
    the state of another analysis of a ready clip, None if there is none; is_changed: whether a
    client has changed the hints or the recording since the analysis; origin: of an edited copy,
    None for any other clip; changed_version: library version of the last change that searches see,
    0 if the clip was never ready.
    """

    id: str
    state: ClipState
    path: str | None
    imported: Mapping[str, Any]
    format: str | None
    sha256: str
    frames: int | None
    frame_rate: float | None
    declared_frame_rate: float | None
    duration: float | None
    joints: int | None
    travel: float | None
    speed: float | None
    energy: float | None
    tempo: float | None
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
    start_offset: float | None
    analysis_version: int | None
    reanalysis: Reanalysis | None
    is_changed: bool
    origin: ClipOrigin | None
    changed_version: int

    @property
    def folder(self) -> str | None:
        """The path without its last part; "" if the file was in no folder."""
        return folder_of(self.path)

    @property
    def full_name(self) -> str:
        """The name with the folder of the file before it, for people.

        Many files of a library may have the same name in other folders.
        """
        return f"{self.folder}/{self.name}" if self.folder else self.name

    @property
    def audio_sha256(self) -> str | None:
        """SHA-256 of the recording, None where there is none."""
        return None if self.audio is None else self.audio.sha256

    @property
    def has_audio(self) -> bool:
        """Whether the motion has a recording."""
        return self.audio is not None

    @property
    def audio_begins_at(self) -> float | None:
        """The time of the motion at which the recording begins, seconds.

        It is the client's hint, otherwise the estimate of the analysis; None without a recording.
        """
        if self.audio is None:
            return None
        hint = self.hints.audio_offset
        return self.audio_offset if hint is None else hint

    @property
    def analysis_input(self) -> AnalysisInput:
        """The hints and the recording: the input of the analysis besides the motion file."""
        return self.hints, self.audio_sha256

    @property
    def is_settled(self) -> bool:
        """Whether no analysis of the clip is waiting or running."""
        is_done = self.state in (ClipState.READY, ClipState.FAILED)
        return is_done and self.reanalysis not in REANALYSIS_OPEN


@dataclass(frozen=True, slots=True)
class NewClip:
    """A clip before its analysis; the caller has normalized the labels.

    path: as in `ClipRecord`; sent: the names of the labels and hints that came with the file
    (`meta.KEY` for a key of the metadata), also of those without a value; origin: of an edited
    copy.
    """

    sha256: str
    file_name: str
    file_size: int
    labels: ClipLabels
    hints: AnalysisHints = AnalysisHints()
    skeleton_sha256: str | None = None
    audio: AttachedAudio | None = None
    path: str | None = None
    sent: frozenset[str] = frozenset()
    origin: ClipOrigin | None = None

    @property
    def content_key(self) -> str:
        """Hex SHA-256 that is equal for two clips only if both of their files are the same."""
        return content_key(self.sha256, self.skeleton_sha256)


def content_key(sha256: str, skeleton_sha256: str | None) -> str:
    """The `NewClip.content_key` of a motion file, and of the skeleton file that comes with it."""
    if skeleton_sha256 is None:
        return sha256
    return hashlib.sha256(f"{sha256}+{skeleton_sha256}".encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class ClipFacts:
    """The results of an analysis that are columns of the clip; units as in ClipRecord."""

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
    start_offset: float = 0.0
    travel: float | None = None
    speed: float | None = None
    energy: float | None = None
    tempo: float | None = None


ClipChanges = Mapping[str, Any]
"""New values by field name: fields of ClipLabels and AnalysisHints, and `audio` (AttachedAudio or
None), `path` and `imported`. A field that is absent keeps its value. `metadata` has the keys that
change (None removes a key); None removes all keys."""


def folder_of(path: str | None) -> str | None:
    """A path without its last part; "" if it has only one part, None without a path."""
    return None if path is None else path.rpartition("/")[0]


class AddOutcome(StrEnum):
    """What `add_or_get` did with new content."""

    ADDED = "added"
    """It added a clip, which needs an ingest job."""
    EXISTS = "exists"
    """The library has the same content already; nothing was changed."""
    REQUEUED = "requeued"
    """The same content had failed, or comes with another recording now: its clip is queued again
    and needs an ingest job."""


@dataclass(frozen=True, slots=True)
class AddResult:
    """The result of `add_or_get`."""

    clip: ClipRecord
    outcome: AddOutcome
    replaced_audio: str | None = None
    """SHA-256 of the earlier recording, if another one has replaced it."""

    @property
    def needs_analysis(self) -> bool:
        """Whether the caller has to enqueue an ingest job in the same transaction."""
        return self.outcome is not AddOutcome.EXISTS
