"""Facets: how often each value occurs among some clips of an index, and quartiles of measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import IntArray
from app.search.index.labels import LabelView
from app.store.clips.measures import EVERY

LABELS = ("person", "task", "source", "license", "folder", "word")
NAMES = (*LABELS, *EVERY)
"""All facets."""
MOST_VALUES = 100


@dataclass(frozen=True, slots=True)
class Facet:
    """What clips have of one label or measure.

    values: of a label, with the number of clips of each, the most frequent first, at most
    MOST_VALUES; others: clips with values that are not listed; missing: clips without any;
    quartiles: of a measure: the least, the three quartiles, the largest; None if no clip has it.
    """

    values: tuple[tuple[str, int], ...] = ()
    others: int = 0
    missing: int = 0
    quartiles: tuple[float, ...] | None = None


def facets(labels: LabelView, numbers: IntArray, names: Sequence[str]) -> dict[str, Facet]:
    """The facets `names`, of NAMES, of the clips `numbers` (k,)."""
    return {name: _facet(labels, numbers, name) for name in names}


def _facet(labels: LabelView, numbers: IntArray, name: str) -> Facet:
    if name == "word":
        return _of_words(labels, numbers)
    if name in LABELS:
        counts = np.bincount(labels.coded[name][numbers])
        known = labels.labels.named[name].labels
        found = {known[code]: int(counts[code]) for code in np.flatnonzero(counts)}
        missing = found.pop(None, 0)
        return _counted({str(value): count for value, count in found.items()}, missing)
    values = labels.measured(name)[numbers]
    known_values = values[np.isfinite(values)].astype(np.float64)
    missing = len(values) - len(known_values)
    if not len(known_values):
        return Facet(missing=missing)
    quartiles = np.quantile(known_values, (0.0, 0.25, 0.5, 0.75, 1.0))
    return Facet(missing=missing, quartiles=tuple(quartiles.tolist()))


def _of_words(labels: LabelView, numbers: IntArray) -> Facet:
    """The words; a clip with several words counts for each."""
    codes, sets = labels.word_sets()
    counts = np.bincount(codes[numbers])
    found: dict[str, int] = {}
    missing = 0
    for code in np.flatnonzero(counts):
        if not sets[code]:
            missing += int(counts[code])
        for word in sets[code]:
            found[word] = found.get(word, 0) + int(counts[code])
    return _counted(found, missing)


def _counted(found: dict[str, int], missing: int) -> Facet:
    ranked = sorted(found.items(), key=lambda one: (-one[1], one[0]))
    others = sum(count for _, count in ranked[MOST_VALUES:])
    return Facet(tuple(ranked[:MOST_VALUES]), others, missing)
