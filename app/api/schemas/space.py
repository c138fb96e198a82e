"""The map of all motions."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import ENERGY, SPEED, TEMPO, TRAVEL, Metadata, Outgoing
from app.api.schemas.filters import Filter
from app.search.index.filters import parse_filter
from app.services.find.map import MAX_POINTS, Map, SpaceName
from app.store.clips.filter import ClipFilter
from app.store.clips.measures import MEASURES


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


class SpaceMap(Outgoing):
    """Clips as points; `next` is always null."""

    space: str
    dimensions: int
    variance_kept: float = Field(
        ge=0, le=1, description="Share of the variance of the space that the map shows."
    )
    total: int = Field(
        description="Number of clips that pass the filter; may be more than `items`."
    )
    library_version: int
    model: str | None = Field(description="Id of the model of the symbol space, else null.")
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
