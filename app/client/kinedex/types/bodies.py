"""Objects that calls send. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NotRequired, TypedDict


class Filter(TypedDict):
    """Filters of the clips before they are ranked. A clip must pass all given filters.

    `meta.KEY=VALUE` filters by the metadata of the clips, `not_meta.KEY=VALUE` leaves clips with
    that value out, and `meta.KEY.min=30`, `meta.KEY.max=40` filter by a number.
    `measure.NAME.min` and `measure.NAME.max` are bounds of a measure of `GET /v1/measures`, as in
    `measure.foot_skate.max=0.1`.

    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    min_duration: Seconds.
    max_duration: Seconds.
    min_frame_rate: Frames per second.
    max_frame_rate: Frames per second.
    min_joints: Number of joints.
    max_joints: Number of joints.
    min_travel: Meters that the hips travel over the floor, forth and back.
    max_travel: Meters that the hips travel over the floor, forth and back.
    min_speed: Mean speed of the hips over the floor, meters per second.
    max_speed: Mean speed of the hips over the floor, meters per second.
    min_energy: Mean energy: root mean square speed of the joints, body lengths per second.
    max_energy: Mean energy: root mean square speed of the joints, body lengths per second.
    min_tempo: Beats per minute.
    max_tempo: Beats per minute.
    """

    person: NotRequired[str | Sequence[str] | None]
    task: NotRequired[str | Sequence[str] | None]
    word: NotRequired[str | Sequence[str] | None]
    license: NotRequired[str | Sequence[str] | None]
    source: NotRequired[str | Sequence[str] | None]
    not_person: NotRequired[str | Sequence[str] | None]
    not_task: NotRequired[str | Sequence[str] | None]
    not_word: NotRequired[str | Sequence[str] | None]
    not_license: NotRequired[str | Sequence[str] | None]
    not_source: NotRequired[str | Sequence[str] | None]
    folder: NotRequired[str | Sequence[str] | None]
    not_folder: NotRequired[str | Sequence[str] | None]
    min_duration: NotRequired[float | None]
    max_duration: NotRequired[float | None]
    min_frame_rate: NotRequired[float | None]
    max_frame_rate: NotRequired[float | None]
    min_joints: NotRequired[float | None]
    max_joints: NotRequired[float | None]
    min_travel: NotRequired[float | None]
    max_travel: NotRequired[float | None]
    min_speed: NotRequired[float | None]
    max_speed: NotRequired[float | None]
    min_energy: NotRequired[float | None]
    max_energy: NotRequired[float | None]
    min_tempo: NotRequired[float | None]
    max_tempo: NotRequired[float | None]


class SearchExample(TypedDict):
    """A stored clip, or a part of it, that hits must be like, or must not be like.

    start: Start of the part, seconds.
    end: End of the part, seconds.
    weight: How much it counts, relative to the others.
    against: Whether hits must not be like it.
    """

    clip_id: str
    start: NotRequired[float | None]
    end: NotRequired[float | None]
    weight: NotRequired[float]
    against: NotRequired[bool]
