"""Answers: collection statistics. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Record
from kinedex.types.collections import ItemClip


@dataclass(frozen=True, slots=True)
class CoverageCell(Record):
    """A range of speeds at a range of turns.

    min_speed: Meters per second, of the hips over the floor.
    max_speed: null: no bound.
    min_turn: Degrees per second, to the left positive.
    max_turn: null: no bound.
    seconds: Of the collection.
    library_seconds: Of the clips of the library that were compared.
    """

    min_speed: float
    max_speed: float | None
    min_turn: float | None
    max_turn: float | None
    seconds: float
    library_seconds: float


@dataclass(frozen=True, slots=True)
class CoverageProposal(Record):
    """A clip that would fill cells that are not covered.

    action: add: add this clip of the library. mirror: mirror this clip of the collection (`POST
    /v1/clips/{id}/edits`) and add the copy.
    seconds: It would add to cells that are not covered, at most 1 s of each. Each proposal
    counts what the earlier ones leave.
    """

    action: Literal["add", "mirror"]
    clip: ItemClip
    seconds: float


@dataclass(frozen=True, slots=True)
class CoveredDirection(Record):
    """A direction in which a body moves, relative to where it faces."""

    direction: Literal["forward", "left", "backward", "right"]
    seconds: float
    library_seconds: float


@dataclass(frozen=True, slots=True)
class LabelShare(Record):
    """How many items have a label.

    name: null: items without this label.
    """

    kind: Literal["person", "task", "license"]
    name: str | None
    items: int


@dataclass(frozen=True, slots=True)
class CollectionStatistics(Record):
    """What a collection covers, as motion matching needs it, beside the library.

    items: Items whose clips are ready; others are not counted.
    library_clips: Clips of the library that were compared: at most 500, evenly chosen.
    library_size: Ready clips of the library.
    covered_cells: Cells with at least 1 s in the collection.
    library_cells: Cells with as much in the library.
    pose_share: Share of the library's poses that are near a pose of the collection (within 0.1
    body lengths, RMS over the joints).
    cells: Those with seconds here or in the library.
    proposals: What fills most, the best first.
    """

    items: int
    clips: int
    seconds: float
    library_clips: int
    library_size: int
    covered_cells: int
    library_cells: int
    pose_share: float | None
    cells: list[CoverageCell]
    directions: list[CoveredDirection]
    labels: list[LabelShare]
    proposals: list[CoverageProposal]
