"""The map of all motions."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from app.api.schemas.base import Outgoing
from app.api.schemas.filters import Filter
from app.search.index.filters import parse_filter
from app.services.find.map import MAX_POINTS, Map, SpaceName
from app.store.clips.filter import ClipFilter


class SpaceQuery(Filter):
    """Which map, and of which clips: those that pass every filter."""

    space: SpaceName = Field(
        "symbols", description="The motion symbol space, which is fitted, or motion vectors."
    )
    dimensions: Literal["2", "3"] = "2"
    limit: int = Field(
        10_000, ge=1, le=MAX_POINTS, description="Most points; of more clips, evenly picked ones."
    )

    def as_filter(self) -> ClipFilter:
        """The conditions as the store takes them."""
        return parse_filter(self.given())


class MapPoint(Outgoing):
    """A clip on the map."""

    clip_id: str
    name: str
    person: str | None
    task: str | None
    words: list[str]
    point: list[float] = Field(description="2 or 3 coordinates.")


class SpaceMap(Outgoing):
    """Clips as points; `next` is always null."""

    space: str
    dimensions: int
    variance_kept: float = Field(ge=0, le=1, description="Share of the space that the map shows.")
    total: int = Field(description="Clips that pass the filter; more than there are items?")
    library_version: int
    model: str | None = Field(description="Id of the model that placed the symbols.")
    items: list[MapPoint]
    next: str | None = None

    @classmethod
    def of(cls, query: SpaceQuery, found: Map) -> SpaceMap:
        """The map as the API shows it."""
        points = found.points.tolist()
        return cls(
            space=query.space,
            dimensions=int(query.dimensions),
            variance_kept=min(found.kept, 1.0),
            total=found.total,
            library_version=found.library_version,
            model=found.model,
            items=[
                MapPoint(
                    clip_id=clip.id,
                    name=clip.name,
                    person=clip.person,
                    task=clip.task,
                    words=list(clip.words),
                    point=point,
                )
                for clip, point in zip(found.clips, points, strict=True)
            ],
        )
