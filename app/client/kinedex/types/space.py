"""Answers: space. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Page, Record


@dataclass(frozen=True, slots=True)
class LabelCodes(Record):
    """A label of every clip of a map.

    values: The values that occur, each once.
    codes: For each clip the place of its value in `values`; -1 without one.
    """

    values: list[str]
    codes: list[int]


@dataclass(frozen=True, slots=True)
class MapPoint(Record):
    """A clip on the map.

    path: Path of the file, relative to its import.
    metadata: Values of your own, by key.
    duration: Seconds.
    frame_rate: Frames per second.
    joints: Number of joints.
    travel: Meters that the hips travel over the floor, forth and back.
    speed: Mean speed of the hips over the floor, meters per second.
    energy: Mean energy: root mean square speed of the joints, body lengths per second.
    tempo: Beats per minute. null without beats.
    point: 2 or 3 coordinates.
    """

    clip_id: str
    name: str
    path: str | None
    person: str | None
    task: str | None
    words: list[str]
    license: str | None
    source: str | None
    metadata: dict[str, bool | int | float | str]
    duration: float | None
    frame_rate: float | None
    joints: int | None
    travel: float | None
    speed: float | None
    energy: float | None
    tempo: float | None
    point: list[float]


@dataclass(frozen=True, slots=True)
class MetadataCodes(Record):
    """A key of the metadata, of the clips of a map that have it.

    values: The values that occur, each once.
    clips: The places of the clips that have the key, ascending.
    codes: For each of these clips the place of its value.
    """

    values: list[str | int | float | bool]
    clips: list[int]
    codes: list[int]


@dataclass(frozen=True, slots=True)
class WordCodes(Record):
    """The words of every clip of a map.

    values: The sets of words that occur, each once.
    codes: For each clip the place of its words in `values`.
    """

    values: list[list[str]]
    codes: list[int]


@dataclass(frozen=True, slots=True, eq=False)
class SpaceColumns(Record):
    """Clips as points, as columns: the same place of each list is the same clip.

    variance_kept: Share of the variance of the space that the map shows.
    total: Number of clips that pass the filter; may be more than are shown.
    model: Id of the model of the symbol space, else null.
    points: One list for each dimension. Rounded to 5 significant digits.
    labels: Of person, task, source and license.
    measures: Of duration, frame_rate, joints, travel, speed, energy, tempo; null without one.
    Rounded to 5 significant digits.
    metadata: Of each key that a clip has.
    """

    space: str
    dimensions: int
    variance_kept: float
    total: int
    library_version: int
    model: str | None
    clip_ids: list[str]
    points: Array
    labels: dict[str, LabelCodes]
    words: WordCodes
    measures: dict[str, list[float | None]]
    metadata: dict[str, MetadataCodes]


@dataclass(frozen=True, slots=True)
class SpaceMap(Page[MapPoint]):
    """Clips as points; `next` is always null.

    variance_kept: Share of the variance of the space that the map shows.
    total: Number of clips that pass the filter; may be more than are shown.
    model: Id of the model of the symbol space, else null.
    """

    space: str
    dimensions: int
    variance_kept: float
    total: int
    library_version: int
    model: str | None
    items: list[MapPoint]
    next: str | None
