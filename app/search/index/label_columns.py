"""The labels of many clips as columns: the values that occur, and for each clip a code of one.

A picture of a whole library needs the labels of every clip, but most values occur many times. As
columns of codes, a hundred thousand clips take tens of milliseconds and a tenth of the bytes that
one record for each clip takes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from app.numerics.arrays import IntArray
from app.search.index.labels import NAMED, LabelView
from app.store.clips.metadata_values import MetadataValue

LABELS = tuple(name for name in NAMED if name != "folder")

NO_VALUE = -1

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class LabelColumn(Generic[T]):
    """values: those that occur, each once. codes: (n,) the place of each clip's value in `values`,
    or -1 for a clip without one."""

    values: Sequence[T]
    codes: IntArray


def label_columns(labels: LabelView, numbers: IntArray) -> dict[str, LabelColumn[str]]:
    """Person, task, license and source of the clips `numbers` (n,) of a view of an index."""
    return {
        name: _used(labels.coded[name][numbers], labels.labels.named[name].labels)
        for name in LABELS
    }


def word_column(labels: LabelView, numbers: IntArray) -> LabelColumn[tuple[str, ...]]:
    """The words of the clips `numbers` (n,): each value is a set of words, sorted; none is ()."""
    codes, sets = labels.word_sets()
    return _used(codes[numbers], [tuple(sorted(words)) for words in sets])


@dataclass(frozen=True, slots=True)
class MetadataColumn:
    """A key of the metadata. Most clips have few of the keys, so only those that have it are named.

    clips: (m,) the places of the clips that have the key, ascending. column: their values, (m,).
    """

    clips: IntArray
    column: LabelColumn[MetadataValue]


def metadata_columns(labels: LabelView, numbers: IntArray) -> Mapping[str, MetadataColumn]:
    """The metadata of the clips `numbers` (n,), by key; a place is one in `numbers`."""
    coded = labels.labels.metadata.coded(numbers)
    return {
        key: MetadataColumn(clips, _used(codes, values))
        for key, (clips, codes, values) in sorted(coded.items())
    }


def _used(codes: IntArray, labels: Sequence[T | None]) -> LabelColumn[T]:
    """The column of the labels that the clips have now: an index keeps those that clips had."""
    used, places = np.unique(codes, return_inverse=True)
    present = np.array([code >= 0 and labels[code] is not None for code in used], dtype=bool)
    # the places of the values that stay, -1 for the others
    kept = np.where(present, np.cumsum(present) - 1, NO_VALUE)
    values = [label for code in used[present] if (label := labels[code]) is not None]
    return LabelColumn(values, kept[places])
