"""The columns of the index: what filters look at, one entry a clip, kept in step.

Names become small integers, so that a filter over a million clips is a few array
comparisons; rows are removed by moving the last one into the gap.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.store.clip_filter import ClipFilter
from app.store.clip_record import ClipRecord

NAMED = ("person", "task", "license", "source")
_FIRST_CAPACITY = 1024


@dataclass(slots=True)
class Rows:
    """Growing columns of `count` clips and their vectors.

    ids: (capacity,) objects; vectors: (capacity, width) float32; squares: (capacity,) their
    squared lengths; durations: (capacity,) seconds; named: (capacity,) int32 codes by label.
    """

    width: int
    count: int = 0
    ids: np.ndarray = field(init=False)
    vectors: FloatArray = field(init=False)
    squares: FloatArray = field(init=False)
    durations: FloatArray = field(init=False)
    words: np.ndarray = field(init=False)
    named: dict[str, IntArray] = field(init=False)
    codes: dict[str, dict[str | None, int]] = field(init=False)
    row_of: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Empty columns."""
        self.ids = np.empty(_FIRST_CAPACITY, dtype=object)
        self.vectors = np.zeros((_FIRST_CAPACITY, self.width), dtype=np.float32)
        self.squares = np.zeros(_FIRST_CAPACITY, dtype=np.float32)
        self.durations = np.zeros(_FIRST_CAPACITY)
        self.words = np.empty(_FIRST_CAPACITY, dtype=object)
        self.named = {name: np.zeros(_FIRST_CAPACITY, dtype=np.int32) for name in NAMED}
        self.codes = {name: {} for name in NAMED}

    def put(self, clip: ClipRecord, vector: FloatArray) -> None:
        """Add a clip, or write over what was known of it."""
        row = self.row_of.setdefault(clip.id, self.count)
        if row == self.count:
            self.count += 1
            self._grow()
        self.ids[row] = clip.id
        self.vectors[row] = vector
        self.squares[row] = self.vectors[row] @ self.vectors[row]
        self.durations[row] = clip.duration or 0.0
        self.words[row] = frozenset(clip.words)
        for name in NAMED:
            codes = self.codes[name]
            self.named[name][row] = codes.setdefault(getattr(clip, name), len(codes))

    def remove(self, clip_id: str) -> None:
        """Forget a clip; nothing happens if it is not known."""
        row = self.row_of.pop(clip_id, None)
        if row is None:
            return
        self.count -= 1
        last = self.count
        for column in self._columns():
            column[row] = column[last]
        self.ids[last] = self.words[last] = None
        if row != last:
            self.row_of[self.ids[row]] = row

    def passing(self, wanted: ClipFilter, exclude: frozenset[str]) -> IntArray:
        """Rows of the clips that pass a filter and are not excluded, ascending.

        The state and the name are not looked at: every row is a ready clip.
        """
        mask = self._within(wanted)
        for name in NAMED:
            if values := getattr(wanted, name):
                codes = [self.codes[name][value] for value in values if value in self.codes[name]]
                mask &= np.isin(self.named[name][: self.count], codes)
        for clip_id in exclude & self.row_of.keys():
            mask[self.row_of[clip_id]] = False
        rows = np.flatnonzero(mask)
        if wanted.word:
            words = frozenset(wanted.word)
            rows = rows[[not words.isdisjoint(carried) for carried in self.words[rows]]]
        return rows

    def _within(self, wanted: ClipFilter) -> BoolArray:
        durations = self.durations[: self.count]
        mask = np.ones(self.count, dtype=bool)
        if wanted.min_duration is not None:
            mask &= durations >= wanted.min_duration
        if wanted.max_duration is not None:
            mask &= durations <= wanted.max_duration
        return mask

    def _columns(self) -> list[np.ndarray]:
        return [
            self.ids,
            self.vectors,
            self.squares,
            self.durations,
            self.words,
            *self.named.values(),
        ]

    def _grow(self) -> None:
        """Double the capacity when it is used up."""
        if self.count <= len(self.ids):
            return
        self.ids, self.words = _doubled(self.ids), _doubled(self.words)
        self.vectors, self.squares = _doubled(self.vectors), _doubled(self.squares)
        self.durations = _doubled(self.durations)
        self.named = {name: _doubled(column) for name, column in self.named.items()}


def _doubled(column: np.ndarray) -> np.ndarray:
    return np.concatenate([column, np.empty_like(column)])
