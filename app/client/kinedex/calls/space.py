"""Calls: space. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.space import SpaceMap


def get_space(
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
    min_duration: float | None = None,
    max_duration: float | None = None,
    space: Literal["symbols", "vectors"] | None = None,
    dimensions: int | None = None,
    limit: int | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
) -> Call[SpaceMap]:
    """Every ready clip as a point in two or three dimensions. Similar clips are close together.

    not_person: Clips of none of these persons.
    not_task: Clips of none of these tasks.
    not_word: Clips with none of these words.
    not_license: Clips with none of these licenses.
    not_source: Clips from none of these sources.
    folder: Clips whose files were in this folder of an import, or below it.
    not_folder: Clips of none of these folders.
    min_duration: Seconds.
    max_duration: Seconds.
    space: symbols: the motion symbol space (fitted). vectors: the motion vectors. Default:
        symbols.
    dimensions: Default: 2.
    limit: Maximum number of points. Of more clips, an even selection is shown. Default: 10000.
    filter: Filters by name, as in a search, for those that are no arguments: {"meta.condition":
        "tired", "meta.age.min": 30}.
    """
    from kinedex.types.space import SpaceMap

    return Call(
        "get_space",
        "GET",
        "/v1/space",
        record(SpaceMap),
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
            min_duration=min_duration,
            max_duration=max_duration,
            space=space,
            dimensions=dimensions,
            limit=limit,
        )
        | given(**(filter or {})),
    )
