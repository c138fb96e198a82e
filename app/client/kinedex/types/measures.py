"""Answers: measures. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from kinedex.records import Record
from kinedex.types.choices import ClipState, Reanalysis
from kinedex.types.clip_remarks import ClipWarning
from kinedex.types.clips import ClipOrigin
from kinedex.types.problem import Problem


@dataclass(frozen=True, slots=True)
class MeasureSummary(Record):
    """A measure of clips, and its values in the library.

    name: Sort by it with `sort`, filter by `measure.NAME.min` and .max.
    is_fault: Whether large values speak against the recording.
    count: Clips that have it.
    quantiles: Deciles of the library: 11 numbers from the least to the largest value; empty if
    no clip has the measure.
    counts: How many of the clips that pass the filter lie in each tenth of the library, from
    the lowest to the highest. A value at a decile counts in the tenth above.
    """

    name: str
    unit: str
    definition: str
    is_fault: bool
    count: int
    quantiles: list[float]
    counts: list[int]


@dataclass(frozen=True, slots=True)
class MeasureList(Record):
    """All measures."""

    items: list[MeasureSummary]


@dataclass(frozen=True, slots=True)
class MeasuredValue(Record):
    """A measure of one clip.

    value: null if the clip does not have it.
    percentile: Percentage of the library's clips with a smaller value; equal values count by
    half.
    """

    value: float | None
    unit: str
    percentile: float | None


@dataclass(frozen=True, slots=True)
class MeasuredClip(Record):
    """A clip with its measures.

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
    measures: By name; `GET /v1/measures` defines them.
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
    measures: dict[str, MeasuredValue]
