"""The labels of the clips in an index, as columns of small integers that filters compare.

Columns only grow. A search reads a `LabelView`: the first entries of the columns, which later
changes do not affect. So searches need no lock.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.index.column import Column
from app.search.index.metadata import MetadataColumns
from app.search.ranking.ranking import IdArray
from app.store.clips.filter import ClipFilter, is_in_folder
from app.store.clips.index_feed import IndexedClip
from app.store.clips.license_policy import allowed_licenses
from app.store.clips.measures import FOUND, QUALITY
from app.store.clips.visibility import visible_source

NAMED = ("person", "task", "license", "source", "folder")


class Coded:
    """A column of labels, each stored as a small integer; a new label gets the next integer."""

    def __init__(self) -> None:
        self.column = Column(np.int32)
        self._labels: list[str | None] = []
        self._code_of: dict[str | None, int] = {}

    def extend(self, labels: Iterable[str | None]) -> None:
        """Add labels."""
        self.column.extend([self._code(label) for label in labels])

    def at(self, number: int) -> str | None:
        """The label of an entry."""
        return self._labels[int(self.column.view()[number])]

    @property
    def labels(self) -> tuple[str | None, ...]:
        """All labels that clips have or had, by code."""
        return tuple(self._labels)

    def codes(self, labels: Iterable[str]) -> list[int]:
        """The codes of the labels; labels that no clip ever had are left out."""
        return [self._code_of[label] for label in labels if label in self._code_of]

    def codes_below(self, folders: Iterable[str]) -> list[int]:
        """The codes of labels that are one of these folders or are below one of them."""
        parents = tuple(folders)
        return [
            code
            for code, label in enumerate(tuple(self._labels))
            if label is not None and any(is_in_folder(label, parent) for parent in parents)
        ]

    def _code(self, label: str | None) -> int:
        code = self._code_of.get(label)
        if code is None:
            code = len(self._labels)
            self._labels.append(label)
            self._code_of[label] = code
        return code


class CodedWords:
    """A column of sets of words, each stored as a small integer, and the sets of each word.

    Many clips have equal sets, so a filter by words checks each set once, then each clip's code.
    """

    def __init__(self) -> None:
        self.column = Column(np.int32)
        self._sets: list[frozenset[str]] = []
        self._code_of: dict[frozenset[str], int] = {}
        self._with_word: dict[str, list[int]] = {}

    def extend(self, sets: Iterable[frozenset[str]]) -> None:
        """Add sets of words."""
        self.column.extend([self._code(words) for words in sets])

    def codes(self, words: Iterable[str]) -> list[int]:
        """The codes of the sets that contain any of `words`."""
        return [code for word in set(words) for code in tuple(self._with_word.get(word, ()))]

    @property
    def sets(self) -> tuple[frozenset[str], ...]:
        """All sets that clips have or had, by code."""
        return tuple(self._sets)

    def at(self, number: int) -> frozenset[str]:
        """The set of an entry."""
        return self._sets[int(self.column.view()[number])]

    def _code(self, words: frozenset[str]) -> int:
        code = self._code_of.get(words)
        if code is None:
            code = len(self._sets)
            self._sets.append(words)
            self._code_of[words] = code
            for word in words:
                self._with_word.setdefault(word, []).append(code)
        return code


@dataclass(frozen=True, slots=True)
class LabelView:
    """The labels of n clips at one moment, by the clips' numbers 0..n-1.

    ids: (n,) objects; alive: (n,) whether the clip was not removed; durations: (n,) seconds;
    measures: (n, m) in the order of FOUND, NaN for those that a clip lacks; quality: (n, q) float32
    in the order of QUALITY, the same; created: (n,) seconds since 1970; coded: the columns of codes
    (n,) by label; labels: maps labels to codes.
    """

    ids: IdArray
    alive: BoolArray
    durations: FloatArray
    measures: FloatArray
    quality: FloatArray
    created: FloatArray
    coded: dict[str, IntArray]
    labels: Labels

    def mask(self, clip_filter: ClipFilter, exclude: Iterable[str] = ()) -> BoolArray:
        """(n,) whether each clip passes a filter, is visible (`visibility`), has an allowed
        license (`license_policy`) and is not excluded.

        The filter's state and name are ignored: every clip here is ready.
        """
        mask = self.alive & self._passes(clip_filter)
        source = visible_source()
        if source is not None:
            mask &= _any_of(self.coded["source"], self.labels.named["source"].codes([source]))
        if licenses := allowed_licenses():
            mask &= _any_of(self.coded["license"], self.labels.named["license"].codes(licenses))
        for clip_id in exclude:
            mask[self._numbers_of(clip_id)] = False
        return mask

    def _passes(self, clip_filter: ClipFilter) -> BoolArray:
        """(n,) whether each clip passes a filter and the filters below it."""
        mask = np.ones(len(self.ids), dtype=bool)
        for name, least, most in clip_filter.ranges():
            values = self.measured(name)
            mask &= values >= (-np.inf if least is None else least)
            mask &= values <= (np.inf if most is None else most)
        if clip_filter.created_after is not None:
            mask &= self.created >= clip_filter.created_after.timestamp()
        if clip_filter.created_before is not None:
            mask &= self.created < clip_filter.created_before.timestamp()
        for name, codes in self.labels.codes(clip_filter).items():
            mask &= _any_of(self.coded[name], codes)
        for name, codes in self.labels.codes(clip_filter, negated=True).items():
            mask &= ~_any_of(self.coded[name], codes)
        for condition in clip_filter.metadata:
            mask &= self.labels.metadata.mask(condition, len(mask))
        for is_asked, ids in clip_filter.id_conditions():
            if is_asked:
                mask &= self._is_one_of(ids)
        return self._below(clip_filter, mask)

    def _below(self, clip_filter: ClipFilter, mask: BoolArray) -> BoolArray:
        """(n,) the clips in `mask` (n,) that pass the filters below a filter."""
        for one in clip_filter.all_of:
            mask &= self._passes(one)
        if clip_filter.any_of:
            mask &= np.logical_or.reduce([self._passes(one) for one in clip_filter.any_of])
        for one in clip_filter.none_of:
            mask &= ~self._passes(one)
        return mask

    def _is_one_of(self, clip_ids: Iterable[str]) -> BoolArray:
        """(n,) whether each clip is one of these."""
        chosen = np.zeros(len(self.ids), dtype=bool)
        numbers = self.find(np.array([*clip_ids], dtype=object))
        chosen[numbers[numbers >= 0]] = True
        return chosen

    def measured(self, name: str) -> FloatArray:
        """(n,) a measure of each clip, NaN for clips without it."""
        if name in QUALITY:
            return self.quality[:, QUALITY.index(name)]
        return self.durations if name == "duration" else self.measures[:, FOUND.index(name)]

    def word_sets(self) -> tuple[IntArray, tuple[frozenset[str], ...]]:
        """(n,) the code of each clip's set of words, and the sets by code."""
        return self.coded["word"], self.labels.words.sets

    def numbers(self, ids: IdArray) -> IntArray:
        """(m,) the numbers of clips (m,), which must be in the index."""
        return np.array([self._numbers_of(clip_id)[-1] for clip_id in ids], dtype=np.int64)

    def find(self, ids: IdArray) -> IntArray:
        """(m,) the numbers of clips (m,), -1 for those that are not in the index.

        A clip that changed after this view was made counts as one that is not in it. To look for
        its earlier number takes a pass over all clips.
        """
        numbers = (self.labels.number_of.get(clip_id, -1) for clip_id in ids)
        return np.array([n if n < len(self.ids) else -1 for n in numbers], dtype=np.int64)

    def _numbers_of(self, clip_id: str) -> list[int]:
        number = self.labels.number_of.get(clip_id)
        if number is not None and number < len(self.ids):
            return [number]
        # The clip changed or was deleted after this view was made, or it was never in the index.
        return [int(n) for n in np.flatnonzero(self.ids == clip_id) if self.alive[n]]


class Labels:
    """The labels of clips; clips are added and removed.

    A changed clip is removed and added again with a new number. Numbers are never used twice.
    """

    def __init__(self) -> None:
        self.number_of: dict[str, int] = {}
        self.words = CodedWords()
        self.metadata = MetadataColumns()
        self.named = {name: Coded() for name in NAMED}
        self._ids = Column(object)
        self._durations = Column(np.float64)
        self._measures = Column(np.float64, (len(FOUND),))
        self._quality = Column(np.float32, (len(QUALITY),))
        self._created = Column(np.float64)
        self._alive = Column(np.bool_)

    def __len__(self) -> int:
        """The number of clips that were not removed."""
        return len(self.number_of)

    @property
    def used(self) -> int:
        """The number of clips that were added so far, with the removed ones."""
        return len(self._ids)

    def add(self, clips: Sequence[IndexedClip]) -> None:
        """Add clips that are not in the index; they get the next numbers."""
        first = self.used
        self._ids.extend([clip.id for clip in clips])
        self._durations.extend([clip.duration for clip in clips])
        self._measures.extend([clip.measures for clip in clips])
        self._quality.extend([clip.quality for clip in clips])
        self._created.extend([clip.created for clip in clips])
        self._alive.extend(np.ones(len(clips), dtype=bool))
        self.words.extend(clip.words for clip in clips)
        self.metadata.extend(clip.metadata for clip in clips)
        for name, coded in self.named.items():
            coded.extend(getattr(clip, name) for clip in clips)
        self.number_of.update((clip.id, first + i) for i, clip in enumerate(clips))

    def remove(self, clip_ids: Iterable[str]) -> list[int]:
        """Remove the clips that are in the index, and return their numbers."""
        numbers = [self.number_of.pop(i) for i in clip_ids if i in self.number_of]
        if numbers:
            self._alive = self._alive.copy()  # earlier views must not change
            self._alive.view()[numbers] = False
        return numbers

    def codes(self, clip_filter: ClipFilter, *, negated: bool = False) -> dict[str, list[int]]:
        """For each label in a filter, the codes of its values.

        negated: of the `not_` conditions, instead of the others.
        """
        prefix = "not_" if negated else ""
        codes = {
            name: coded.codes_below(values) if name == "folder" else coded.codes(values)
            for name, coded in self.named.items()
            if (values := getattr(clip_filter, prefix + name))
        }
        words = getattr(clip_filter, prefix + "word")
        return codes | ({"word": self.words.codes(words)} if words else {})

    def clip_at(self, number: int, array: NDArray[Any] | None) -> IndexedClip:
        """A clip with the labels with which it was added, and an array."""
        named = {name: coded.at(number) for name, coded in self.named.items()}
        return IndexedClip(
            id=self._ids.view()[number],
            is_ready=True,
            duration=float(self._durations.view()[number]),
            words=self.words.at(number),
            metadata=self.metadata.at(number),
            measures=tuple(self._measures.view()[number].tolist()),
            quality=tuple(self._quality.view()[number].tolist()),
            created=float(self._created.view()[number]),
            array=array,
            **named,
        )

    def view(self) -> LabelView:
        """The labels at this moment."""
        coded = {name: coded.column.view() for name, coded in self.named.items()}
        return LabelView(
            ids=self._ids.view(),
            alive=self._alive.view(),
            durations=self._durations.view(),
            measures=self._measures.view(),
            quality=self._quality.view(),
            created=self._created.view(),
            coded=coded | {"word": self.words.column.view()},
            labels=self,
        )


def _any_of(column: IntArray, codes: Sequence[int]) -> BoolArray:
    """(n,) whether each code of `column` (n,) is one of `codes`."""
    if len(codes) < 2:
        return np.asarray(column == codes[0] if codes else np.zeros(len(column), dtype=bool))
    # one lookup for each entry, whatever the number of codes
    table = np.zeros(int(column.max(initial=0)) + 1, dtype=bool)
    chosen = np.array(codes)
    table[chosen[chosen < len(table)]] = True
    return np.asarray(table[column])
