"""Calls: measures. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.measures import MeasureList


def list_measures(
    *,
    person: str | Sequence[str] | None = None,
    task: str | Sequence[str] | None = None,
    word: str | Sequence[str] | None = None,
    license: str | Sequence[str] | None = None,
    source: str | Sequence[str] | None = None,
    not_person: str | Sequence[str] | None = None,
    not_task: str | Sequence[str] | None = None,
    not_word: str | Sequence[str] | None = None,
    not_license: str | Sequence[str] | None = None,
    not_source: str | Sequence[str] | None = None,
    folder: str | Sequence[str] | None = None,
    not_folder: str | Sequence[str] | None = None,
    collection: str | Sequence[str] | None = None,
    annotation: str | Sequence[str] | None = None,
    created_after: str | None = None,
    created_before: str | None = None,
    where: Mapping[str, Any] | str | None = None,
    min_duration: float | None = None,
    max_duration: float | None = None,
    min_frame_rate: float | None = None,
    max_frame_rate: float | None = None,
    min_joints: float | None = None,
    max_joints: float | None = None,
    min_travel: float | None = None,
    max_travel: float | None = None,
    min_speed: float | None = None,
    max_speed: float | None = None,
    min_energy: float | None = None,
    max_energy: float | None = None,
    min_tempo: float | None = None,
    max_tempo: float | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
) -> Call[MeasureList]:
    """The measures of clips, each with unit, definition, and deciles of the library.

    With a filter, `counts` says how the clips that pass it are spread over the deciles.

    task: Kinds of it too, as of a word (`/v1/labels/tree`); none with = before it.
    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    collection: Ids of collections: clips in any of them.
    annotation: Words: clips with an annotation that has any of them, or a kind of it.
    created_after: Clips that came at this time or later, ISO 8601; UTC without a zone.
    created_before: Clips that came before this time.
    where: A tree of filters, as JSON: {"any_of": [{"task": "walk"}, {"none_of": [{"person":
        "ada"}]}]}. `all_of`, `any_of` and `none_of` are arrays of filters with the keys of this
        one; at most 5 inside each other, and 50 in all.
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
    filter: Filters by name, as in a search, for those that are no arguments: {"meta.condition":
        "tired", "meta.age.min": 30}.
    """
    from kinedex.types.measures import MeasureList

    return Call(
        "list_measures",
        "GET",
        "/v1/measures",
        record(MeasureList),
        query=given(
            person=person,
            task=task,
            word=word,
            license=license,
            source=source,
            not_person=not_person,
            not_task=not_task,
            not_word=not_word,
            not_license=not_license,
            not_source=not_source,
            folder=folder,
            not_folder=not_folder,
            collection=collection,
            annotation=annotation,
            created_after=created_after,
            created_before=created_before,
            where=where,
            min_duration=min_duration,
            max_duration=max_duration,
            min_frame_rate=min_frame_rate,
            max_frame_rate=max_frame_rate,
            min_joints=min_joints,
            max_joints=max_joints,
            min_travel=min_travel,
            max_travel=max_travel,
            min_speed=min_speed,
            max_speed=max_speed,
            min_energy=min_energy,
            max_energy=max_energy,
            min_tempo=min_tempo,
            max_tempo=max_tempo,
        )
        | given(**(filter or {})),
    )
