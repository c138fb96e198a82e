"""Answers: clips. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from kinedex.records import Page, Record
from kinedex.types.choices import ClipState, Reanalysis
from kinedex.types.clip_remarks import ClipWarning, Difference
from kinedex.types.jobs import Job
from kinedex.types.problem import Problem


@dataclass(frozen=True, slots=True)
class ClipOrigin(Record):
    """Where an edited copy comes from.

    clip_id: The id of the original.
    deleted: Whether the original was deleted since.
    steps: The edits in their order, each with its `kind`. Those that keep a part have its
    `start` and `end`, seconds of the motion before the step.
    """

    clip_id: str
    deleted: bool
    steps: list[dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Clip(Record):
    """A motion-capture clip with its labels.

    path: Path of the file, relative to its import; null for a file without a path.
    captions: Sentences that describe the motion.
    metadata: Values of your own, by key.
    frame_rate: Frames per second, as used.
    declared_frame_rate: Frames per second, as the file says.
    duration: Seconds.
    start_offset: Seconds from the start of the file to the clip's first frame. Add them to a
    time of the clip to find it in your own program. It is 0 unless frames at the start have no
    body, or the animation begins later; negative if the animation begins before 0 s.
    joints: Number of joints.
    travel: Meters that the hips travel over the floor, forth and back.
    speed: Mean speed of the hips over the floor, meters per second.
    energy: Mean energy: root mean square speed of the joints, body lengths per second.
    tempo: Beats per minute. null without beats.
    roles: Joint name by joint role.
    has_audio: Whether the clip has a recording: GET .../audio.
    audio_offset: Time in the motion at which the recording begins, seconds, as given or
    estimated. An estimate may be wrong by whole beats: the warning `audio_offset_estimated`
    gives the length of a beat, and the probability that the estimate is right.
    error: The reason why the clip is `failed`, else null.
    reanalysis: State of a new analysis of a ready clip, after a change of the clip or of
    Kinedex. It is null when the new analysis is done. Until then, searches use the earlier
    analysis. After `failed` they still use it, and a warning gives the reason.
    origin: Of a clip that an edit made (`POST /v1/clips/{id}/edits`), else null.
    """

    id: str
    name: str
    path: str | None
    state: ClipState
    format: str | None
    sha256: str
    person: str | None
    task: str | None
    words: list[str]
    captions: list[str]
    license: str | None
    source: str | None
    metadata: dict[str, bool | int | float | str]
    frames: int | None
    frame_rate: float | None
    declared_frame_rate: float | None
    duration: float | None
    start_offset: float | None
    joints: int | None
    travel: float | None
    speed: float | None
    energy: float | None
    tempo: float | None
    roles: dict[str, str]
    missing_roles: list[str]
    warnings: list[ClipWarning]
    created_at: datetime
    has_audio: bool
    audio_offset: float | None
    error: Problem | None
    reanalysis: Reanalysis | None
    origin: ClipOrigin | None


@dataclass(frozen=True, slots=True)
class ClipCreated(Record):
    """A stored clip, and the job that will make it ready.

    differences: If the library had the same bytes already: what came with other values.
    """

    clip: Clip
    job: Job | None
    differences: list[Difference]


@dataclass(frozen=True, slots=True)
class ClipList(Page[Clip]):
    """A page of clips.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[Clip]
