"""The clip as the store tells it: the fields of DESIGN 8's Clip and what a re-analysis needs."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any, TypedDict


class ClipState(StrEnum):
    """Where a clip stands."""

    QUEUED = "queued"
    """Stored durably; waits for a worker."""
    PROCESSING = "processing"
    """A worker is analysing it."""
    READY = "ready"
    """Analysed: the next search finds it."""
    FAILED = "failed"
    """Cannot be analysed; `error` says why. Listed, never searched."""


class Reanalysis(StrEnum):
    """Where another analysis of a ready clip stands."""

    QUEUED = "queued"
    """It waits for a worker."""
    PROCESSING = "processing"
    """A worker does it."""
    FAILED = "failed"
    """It could not be done: a warning says why."""


REANALYSIS_OPEN = (Reanalysis.QUEUED, Reanalysis.PROCESSING)


@dataclass(frozen=True, slots=True)
class ClipWarning:
    """A doubt about a clip: `code` for machines, `detail` for people, `likely` a better value."""

    code: str
    detail: str
    likely: float | None = None


OVERRIDES = (
    "frame_rate_override",
    "metres_per_unit_override",
    "roles_override",
    "stack_override",
    "audio_sha256",
    "audio_offset_override",
    "tempo_override",
    "beats_override",
)
"""Fields of a clip on which its analysis depends beside its file."""


@dataclass(frozen=True, slots=True)
class ClipRecord:
    """A clip's row. What the analysis finds is None (or empty) until the clip is ready.

    sha256: of the file's own bytes; content_key: what makes the clip one of a kind (the same,
    or with a skeleton companion a hash of both); roles: joint name by role; durations in
    seconds, rates in Hz; error: an RFC 9457 problem; *_override: what the client said, which
    wins over what the file says; audio_*: the recording that goes with the motion, its bytes,
    their name and number, audio_offset the time of the motion (s) at which it begins, if known;
    reanalysis: of a ready clip, where another analysis stands, None where there is none to come;
    is_changed: whether what the client said has changed since the analysis; changed_version:
    library version of the last change that searches see, 0 while it was never searchable.
    """

    id: str
    name: str
    state: ClipState
    format: str | None
    sha256: str
    person: str | None
    task: str | None
    words: tuple[str, ...]
    license: str | None
    source: str | None
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
    frame_rate_override: float | None
    metres_per_unit_override: float | None
    roles_override: dict[str, str] | None
    stack_override: str | None
    audio_sha256: str | None
    audio_name: str | None
    audio_size: int | None
    audio_offset_override: float | None
    tempo_override: float | None
    beats_override: tuple[float, ...] | None
    audio_offset: float | None
    analysis_version: int | None
    reanalysis: Reanalysis | None
    is_changed: bool
    changed_version: int

    @property
    def overrides(self) -> tuple[Any, ...]:
        """What the client said of the file, as named in OVERRIDES: an analysis depends on it."""
        return tuple(getattr(self, name) for name in OVERRIDES)

    @property
    def is_settled(self) -> bool:
        """Whether no analysis of it is to come."""
        is_done = self.state in (ClipState.READY, ClipState.FAILED)
        return is_done and self.reanalysis not in REANALYSIS_OPEN


@dataclass(frozen=True, slots=True)
class NewClip:
    """What is known of a clip before its analysis; words are normalised by the caller."""

    sha256: str
    file_name: str
    file_size: int
    name: str
    person: str | None = None
    task: str | None = None
    words: tuple[str, ...] = ()
    license: str | None = None
    source: str | None = None
    format: str | None = None
    skeleton_sha256: str | None = None
    frame_rate_override: float | None = None
    metres_per_unit_override: float | None = None
    roles_override: dict[str, str] | None = None
    stack_override: str | None = None
    audio_sha256: str | None = None
    audio_name: str | None = None
    audio_size: int | None = None
    audio_offset_override: float | None = None
    tempo_override: float | None = None
    beats_override: tuple[float, ...] | None = None

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


class ClipChanges(TypedDict, total=False):
    """What a PATCH may change; a key that is absent stays, None takes a value away."""

    name: str
    person: str | None
    task: str | None
    words: Sequence[str]
    license: str | None
    source: str | None
    frame_rate_override: float | None
    metres_per_unit_override: float | None
    roles_override: dict[str, str] | None
    stack_override: str | None
    audio_sha256: str | None
    audio_name: str | None
    audio_size: int | None
    audio_offset_override: float | None
    tempo_override: float | None
    beats_override: tuple[float, ...] | None


class AddOutcome(StrEnum):
    """What became of content that was handed in."""

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
