"""The map of all motions."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from app.api.schemas.base import ENERGY, SPEED, TEMPO, TRAVEL, Metadata, Outgoing
from app.api.schemas.filters import Filter
from app.numerics.arrays import FloatArray
from app.numerics.rounding import rounded
from app.search.index.filters import parse_filter
from app.search.index.label_columns import label_columns, metadata_columns, word_column
from app.services.find.map import MAX_POINTS, Map, Placed, SpaceName
from app.store.clips.filter import ClipFilter
from app.store.clips.measures import MEASURES

DIGITS = 5
"""Significant digits of the numbers of a map in columns: no screen shows more."""


class SpaceQuery(Filter):
    """The kind of map, and filters of its clips. A clip must pass all given filters."""

    space: SpaceName = Field(
        "symbols",
        description="symbols: the motion symbol space (fitted). vectors: the motion vectors.",
    )
    dimensions: int = Field(2, ge=2, le=3)
    limit: int = Field(
        10_000,
        ge=1,
        le=MAX_POINTS,
        description="Maximum number of points. Of more clips, an even selection is shown.",
    )

    def as_filter(self) -> ClipFilter:
        """The filter of the store."""
        return parse_filter(self.given())


class MapPoint(Outgoing):
    """A clip on the map."""

    clip_id: str
    name: str
    path: str | None = Field(description="Path of the file, relative to its import.")
    person: str | None
    task: str | None
    words: list[str]
    license: str | None
    source: str | None
    metadata: Metadata = Field(description="Values of your own, by key.")
    duration: float | None = Field(description="Seconds.")
    frame_rate: float | None = Field(description="Frames per second.")
    joints: int | None = Field(description="Number of joints.")
    travel: float | None = Field(description=TRAVEL)
    speed: float | None = Field(description=SPEED)
    energy: float | None = Field(description=ENERGY)
    tempo: float | None = Field(description=f"{TEMPO} null without beats.")
    point: list[float] = Field(description="2 or 3 coordinates.")


class _Drawn(Outgoing):
    """What every form of a map says of itself."""

    space: str
    dimensions: int
    variance_kept: float = Field(
        ge=0, le=1, description="Share of the variance of the space that the map shows."
    )
    total: int = Field(
        description="Number of clips that pass the filter; may be more than are shown."
    )
    library_version: int
    model: str | None = Field(description="Id of the model of the symbol space, else null.")


class SpaceMap(_Drawn):
    """Clips as points; `next` is always null."""

    items: list[MapPoint]
    next: str | None = None

    @classmethod
    def of(cls, query: SpaceQuery, drawn: Map) -> SpaceMap:
        """The map as the API shows it."""
        points = drawn.points.tolist()
        return cls(
            space=query.space,
            dimensions=query.dimensions,
            variance_kept=min(drawn.kept, 1.0),
            total=drawn.total,
            library_version=drawn.library_version,
            model=drawn.model,
            items=[
                MapPoint(
                    clip_id=clip.id,
                    name=clip.name,
                    path=clip.path,
                    person=clip.person,
                    task=clip.task,
                    words=list(clip.words),
                    license=clip.license,
                    source=clip.source,
                    metadata=dict(clip.metadata),
                    **{name: getattr(clip, name) for name in MEASURES},
                    point=point,
                )
                for clip, point in zip(drawn.clips, points, strict=True)
            ],
        )


CODES = "For each clip the place of its value in `values`; -1 without one."


class LabelCodes(Outgoing):
    """A label of every clip of a map."""

    values: list[str] = Field(description="The values that occur, each once.")
    codes: list[int] = Field(description=CODES)


class WordCodes(Outgoing):
    """The words of every clip of a map."""

    values: list[list[str]] = Field(description="The sets of words that occur, each once.")
    codes: list[int] = Field(description="For each clip the place of its words in `values`.")


class MetadataCodes(Outgoing):
    """A key of the metadata, of the clips of a map that have it."""

    values: list[str | int | float | bool] = Field(description="The values that occur, each once.")
    clips: list[int] = Field(description="The places of the clips that have the key, ascending.")
    codes: list[int] = Field(description="For each of these clips the place of its value.")


class SpaceColumns(_Drawn):
    """Clips as points, as columns: the same place of each list is the same clip."""

    clip_ids: list[str]
    points: list[list[float]] = Field(
        description="One list for each dimension. Rounded to 5 significant digits."
    )
    labels: dict[str, LabelCodes] = Field(description="Of person, task, source and license.")
    words: WordCodes
    measures: dict[str, list[float | None]] = Field(
        description=f"Of {', '.join(MEASURES)}; null without one. Rounded to 5 significant digits."
    )
    metadata: dict[str, MetadataCodes] = Field(description="Of each key that a clip has.")

    @classmethod
    def of(cls, query: SpaceQuery, placed: Placed) -> SpaceColumns:
        """The map as the API shows it."""
        labels, numbers = placed.labels, placed.numbers
        coded = label_columns(labels, numbers)
        words = word_column(labels, numbers)
        metadata = metadata_columns(labels, numbers)
        return cls(
            space=query.space,
            dimensions=query.dimensions,
            variance_kept=min(placed.kept, 1.0),
            total=placed.total,
            library_version=placed.library_version,
            model=placed.model,
            clip_ids=placed.ids,
            points=rounded(placed.points, DIGITS).T.tolist(),
            labels={
                name: LabelCodes(values=list(column.values), codes=column.codes.tolist())
                for name, column in coded.items()
            },
            words=WordCodes(
                values=[list(some) for some in words.values], codes=words.codes.tolist()
            ),
            measures={
                name: _or_null(rounded(labels.measured(name)[numbers], DIGITS)) for name in MEASURES
            },
            metadata={
                key: MetadataCodes(
                    values=list(found.column.values),
                    clips=found.clips.tolist(),
                    codes=found.column.codes.tolist(),
                )
                for key, found in metadata.items()
            },
        )


def _or_null(values: FloatArray) -> list[float | None]:
    """The numbers, None for NaN."""
    found = values.astype(object)
    found[np.isnan(values)] = None
    return list(found)
