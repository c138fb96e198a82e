"""The measures of clips beside those of the library: quantiles, percentiles and counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.analysis.quality.definitions import DEFINITIONS, Definition
from app.numerics.arrays import BoolArray, FloatArray
from app.search.index.labels import LabelView
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store.clips import quality
from app.store.clips.filter import ClipFilter
from app.store.clips.measures import EVERY, MEASURES
from app.store.clips.record import ClipRecord

DECILES = np.linspace(0.0, 1.0, 11)
_KNOWN = (
    Definition("duration", "s", "Duration."),
    Definition("frame_rate", "Hz", "Frames per second."),
    Definition("joints", "", "Number of joints."),
    Definition("travel", "m", "Path length: way of the hips over the floor, forth and back."),
    Definition("speed", "m/s", "Mean speed of the hips over the floor."),
    Definition("energy", "lengths/s", "Mean energy: root mean square speed of the joints."),
    Definition("tempo", "beats/min", "Tempo of the beats; missing without beats."),
)
ALL_DEFINITIONS: Mapping[str, Definition] = {one.name: one for one in (*_KNOWN, *DEFINITIONS)}


@dataclass(frozen=True, slots=True)
class MeasureSummary:
    """A measure in the library.

    count: clips that have it. quantiles: (11,) deciles from the least to the largest value, empty
    without any. counts: how many of the clips that pass a filter are in each tenth, between two
    deciles; a value at a decile counts in the tenth above.
    """

    name: str
    unit: str
    text: str
    is_fault: bool
    count: int
    quantiles: tuple[float, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class MeasuredValue:
    """A value, and the percentage of the library's clips whose value is smaller, equal ones by
    half; both None for a measure that the clip does not have."""

    value: float | None
    percentile: float | None
    unit: str


class WithMeasures:
    """A clip with all attributes of its record, and its measures by name."""

    def __init__(self, clip: ClipRecord, measures: Mapping[str, MeasuredValue]) -> None:
        self._clip = clip
        self.measures = measures

    def __getattr__(self, name: str) -> Any:
        return getattr(self._clip, name)


def summaries(lib: Library, filter: ClipFilter) -> list[MeasureSummary]:
    """All measures of the clips that can be found, and counts of those that pass the filter."""
    lib.index.catch_up(lib.store)
    labels = lib.index.state[1].labels
    every, passing = labels.mask(ClipFilter()), labels.mask(resolved_filter(lib, filter))
    return [
        _summary(definition, labels.measured(name)[every], labels.measured(name)[passing])
        for name, definition in ALL_DEFINITIONS.items()
    ]


def _summary(definition: Definition, every: FloatArray, passing: FloatArray) -> MeasureSummary:
    known, some = every[np.isfinite(every)], passing[np.isfinite(passing)]
    deciles = np.quantile(known, DECILES) if len(known) else np.empty(0)
    counts: tuple[int, ...] = ()
    if len(known):
        tenths = np.searchsorted(deciles[1:-1], some, side="right")
        counts = tuple(np.bincount(tenths, minlength=len(DECILES) - 1).tolist())
    return MeasureSummary(
        name=definition.name,
        unit=definition.unit,
        text=definition.text,
        is_fault=definition.is_fault,
        count=len(known),
        quantiles=tuple(deciles.tolist()),
        counts=counts,
    )


def of_clip(lib: Library, clip: ClipRecord) -> dict[str, MeasuredValue]:
    """The measures of a clip by name."""
    with lib.store.read() as tx:
        found = quality.get(tx, clip.id)
    lib.index.catch_up(lib.store)
    labels = lib.index.state[1].labels
    mask = labels.mask(ClipFilter())
    values = {name: getattr(clip, name) if name in MEASURES else found[name] for name in EVERY}
    return {
        name: MeasuredValue(
            value, _percentile(labels, mask, name, value), ALL_DEFINITIONS[name].unit
        )
        for name, value in values.items()
    }


def _percentile(labels: LabelView, mask: BoolArray, name: str, value: float | None) -> float | None:
    if value is None:
        return None
    others = labels.measured(name)[mask]
    known = np.count_nonzero(np.isfinite(others))
    if not known:
        return None
    # comparisons with NaN are false
    below = np.count_nonzero(others < value) + np.count_nonzero(others == value) / 2
    return round(100.0 * below / known, 2)
