"""What a collection covers, and what it lacks."""

from __future__ import annotations

from itertools import pairwise
from math import inf
from typing import Any, Literal

from pydantic import Field

from app.analysis.coverage.coverage import (
    DIRECTIONS,
    ENOUGH_SECONDS,
    SPEED_EDGES,
    TURN_EDGES,
    Coverage,
)
from app.api.schemas.base import Outgoing
from app.api.schemas.collections import ItemClip
from app.services.collections.statistics import MAX_COMPARED, NEAR_POSE, Statistics


class CoverageCell(Outgoing):
    """A range of speeds at a range of turns."""

    min_speed: float = Field(description="Meters per second, of the hips over the floor.")
    max_speed: float | None = Field(description="null: no bound.")
    min_turn: float | None = Field(description="Degrees per second, to the left positive.")
    max_turn: float | None = Field(description="null: no bound.")
    seconds: float = Field(description="Of the collection.")
    library_seconds: float = Field(description="Of the clips of the library that were compared.")


class CoveredDirection(Outgoing):
    """A direction in which a body moves, relative to where it faces."""

    direction: Literal["forward", "left", "backward", "right"]
    seconds: float
    library_seconds: float


class LabelShare(Outgoing):
    """How many items have a label."""

    kind: Literal["person", "task", "license"]
    name: str | None = Field(description="null: items without this label.")
    items: int


class CoverageProposal(Outgoing):
    """A clip that would fill cells that are not covered."""

    action: Literal["add", "mirror"] = Field(
        description="add: add this clip of the library. mirror: mirror this clip of the collection"
        " (`POST /v1/clips/{id}/edits`) and add the copy."
    )
    clip: ItemClip
    seconds: float = Field(
        description=f"It would add to cells that are not covered, at most {ENOUGH_SECONDS:g} s of"
        " each. Each proposal counts what the earlier ones leave."
    )


class CollectionStatistics(Outgoing):
    """What a collection covers, as motion matching needs it, beside the library."""

    items: int = Field(description="Items whose clips are ready; others are not counted.")
    clips: int
    seconds: float
    library_clips: int = Field(
        description=f"Clips of the library that were compared: at most {MAX_COMPARED}, evenly"
        " chosen."
    )
    library_size: int = Field(description="Ready clips of the library.")
    covered_cells: int = Field(
        description=f"Cells with at least {ENOUGH_SECONDS:g} s in the collection."
    )
    library_cells: int = Field(description="Cells with as much in the library.")
    pose_share: float | None = Field(
        description="Share of the library's poses that are near a pose of the collection (within"
        f" {NEAR_POSE:g} body lengths, RMS over the joints)."
    )
    cells: list[CoverageCell] = Field(description="Those with seconds here or in the library.")
    directions: list[CoveredDirection]
    labels: list[LabelShare]
    proposals: list[CoverageProposal] = Field(description="What fills most, the best first.")

    @classmethod
    def of(cls, found: Statistics) -> CollectionStatistics:
        """The answer for the statistics of the service."""
        own, library = found.own, found.library
        return cls(
            items=found.items,
            clips=found.clips,
            seconds=round(found.seconds, 3),
            library_clips=found.of_library,
            library_size=found.library_size,
            covered_cells=_covered(own),
            library_cells=_covered(library),
            pose_share=None if found.pose_share is None else round(found.pose_share, 4),
            cells=_cells(own, library),
            directions=[
                CoveredDirection(
                    direction=name,  # type: ignore[arg-type]
                    seconds=round(float(own.directions[i]), 2),
                    library_seconds=round(float(library.directions[i]), 2),
                )
                for i, name in enumerate(DIRECTIONS)
            ],
            labels=[
                LabelShare(kind=kind, name=name or None, items=count)  # type: ignore[arg-type]
                for kind, counts in found.labels.items()
                for name, count in sorted(counts.items(), key=lambda one: (-one[1], one[0]))
            ],
            proposals=[
                CoverageProposal(
                    action="mirror" if one.is_mirror else "add",
                    clip=ItemClip.model_validate(one.clip),
                    seconds=round(one.seconds, 2),
                )
                for one in found.proposals
            ],
        )


def _covered(coverage: Coverage) -> int:
    return int((coverage.cells >= ENOUGH_SECONDS).sum())


def _cells(own: Coverage, library: Coverage) -> list[CoverageCell]:
    speeds = list(pairwise((*SPEED_EDGES, inf)))
    turns = list(pairwise((-inf, *TURN_EDGES, inf)))
    return [
        CoverageCell(
            min_speed=low,
            max_speed=_finite(high),
            min_turn=_finite(least),
            max_turn=_finite(most),
            seconds=round(float(own.cells[i, j]), 2),
            library_seconds=round(float(library.cells[i, j]), 2),
        )
        for i, (low, high) in enumerate(speeds)
        for j, (least, most) in enumerate(turns)
        if own.cells[i, j] + library.cells[i, j] > 0
    ]


def _finite(value: float) -> Any:
    return None if value in (inf, -inf) else value
