"""Rounds of training and probing. Each holds out takes, a person, a task or a source, or trains
on a fixed number of takes of each cell (a cell is one person at one task)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.errors import NotEnoughLabels
from app.evaluate.recognition.clips import JudgedClips, Labels, names_of
from app.models.holding_out import FOLDS, MIN_LABELS
from app.numerics.arrays import IntArray

MAX_ROUNDS = 40
"""If there are more labels (or recordings), they are left out in groups of even size."""

DRAWS = 5
"""How often takes are drawn from the cells."""


class LeftOut(StrEnum):
    """What is left out of the training."""

    TAKE = "take"
    """A fifth of the recordings; other recordings mostly have the same persons and tasks."""
    PERSON = "person"
    """All clips of a person; clips of known persons are probed too."""
    TASK = "task"
    """All clips of a task; clips of known tasks are probed too."""
    SOURCE = "source"
    """All clips of a source."""


@dataclass(frozen=True, slots=True)
class Round:
    """train, probe: (n,) indices of the clips to learn from and of the clips to recognize.

    left_out: the labels or sources that were left out as a whole; empty if takes were left out.
    """

    left_out: tuple[str, ...]
    train: IntArray
    probe: IntArray


def rounds(clips: JudgedClips, left_out: LeftOut) -> list[Round]:
    """The rounds, sorted by the name of what is left out.

    Raises NotEnoughLabels if nothing can be held out.
    """
    found = {
        LeftOut.TAKE: lambda: _by_fold(clips, FOLDS),
        LeftOut.PERSON: lambda: _by_label(clips, "person"),
        LeftOut.TASK: lambda: _by_label(clips, "task"),
        LeftOut.SOURCE: lambda: _by_source(clips),
    }[left_out]()
    return _usable(found)


def rounds_by_recording(clips: JudgedClips) -> list[Round]:
    """Leave out each recording that has both labels in turn (Vasilescu 2002, section 7).

    Raises NotEnoughLabels if no cell has a second take.
    """
    labeled = _with_both_labels(clips)
    folds = min(MAX_ROUNDS, len({clips.groups[i] for i in labeled}))
    found = [
        Round((), np.intersect1d(one.train, labeled), np.intersect1d(one.probe, labeled))
        for one in _by_fold(clips, max(folds, 1))
    ]
    return _usable(found)


def rounds_by_takes(clips: JudgedClips, takes: int) -> list[Round]:
    """Learn from `takes` random takes of each cell, and probe the others; DRAWS rounds.

    A take is a recording. Only cells with more than `takes` takes are used, so that each cell
    has a probe. Raises NotEnoughLabels unless they cover two persons and two tasks.
    """
    cells = {cell: some for cell, some in _takes(clips).items() if len(some) > takes}
    persons, tasks = (len({cell[factor] for cell in cells}) for factor in (0, 1))
    if min(persons, tasks) < 2:
        raise NotEnoughLabels(
            f"Two persons and two tasks with {takes + 1} takes each are needed; there are "
            f"{len(cells)} such cells of {persons} persons and {tasks} tasks."
        )
    return [_drawn(cells, takes, seed) for seed in range(DRAWS)]


def _with_both_labels(clips: JudgedClips) -> IntArray:
    pairs = enumerate(zip(clips.persons, clips.tasks, strict=True))
    return np.array([i for i, labels in pairs if all(labels)], dtype=np.int64)


def _takes(clips: JudgedClips) -> dict[tuple[str, str], list[list[int]]]:
    """The takes by person and task, sorted by name; a take is a list of clip indices."""
    cells: dict[tuple[str, str], dict[str, list[int]]] = defaultdict(lambda: defaultdict(list))
    for i in _with_both_labels(clips).tolist():
        cell = clips.persons[i] or "", clips.tasks[i] or ""
        cells[cell][clips.groups[i]].append(i)
    return {cell: [some[name] for name in sorted(some)] for cell, some in sorted(cells.items())}


def _drawn(cells: dict[tuple[str, str], list[list[int]]], takes: int, seed: int) -> Round:
    rng = np.random.RandomState(seed)
    train, probe = [], []
    for some in cells.values():
        order = rng.permutation(len(some)).tolist()
        train += [clip for index in order[:takes] for clip in some[index]]
        probe += [clip for index in order[takes:] for clip in some[index]]
    return Round((), np.sort(train), np.sort(probe))


def _by_fold(clips: JudgedClips, folds: int) -> Iterator[Round]:
    fold = _folds(clips, folds)
    for each in range(folds):
        yield Round((), np.flatnonzero(fold != each), np.flatnonzero(fold == each))


def _folds(clips: JudgedClips, folds: int) -> IntArray:
    """(N,) fold of each clip. Recordings of a task, and of a cell, go to the folds in turn. So
    no fold has all recordings of a cell that has several."""
    keys = sorted(
        set(zip(_or_empty(clips.tasks), _or_empty(clips.persons), clips.groups, strict=True))
    )
    fold_of = {group: number % folds for number, (_, _, group) in enumerate(keys)}
    return np.array([fold_of[group] for group in clips.groups], dtype=np.int64)


def _or_empty(labels: Labels) -> list[str]:
    return [label or "" for label in labels]


def _by_label(clips: JudgedClips, factor: str) -> Iterator[Round]:
    """Leave out all clips of a label as new ones, and a fold of the other clips as known ones."""
    labels = clips.labels(factor)
    names = names_of(labels)
    if len(names) < MIN_LABELS:
        raise NotEnoughLabels(
            f"{MIN_LABELS} {factor}s are needed to leave one out; there are {len(names)}."
        )
    fold = _folds(clips, FOLDS)
    for number, group in enumerate(_label_groups(names)):
        new = np.array([label in group for label in labels])
        held = fold == number % FOLDS
        yield Round(tuple(group), np.flatnonzero(~(new | held)), np.flatnonzero(new | held))


def _by_source(clips: JudgedClips) -> Iterator[Round]:
    names = names_of(clips.sources)
    if len(names) < 2:
        raise NotEnoughLabels(
            f"Two sources are needed to leave one out; the clips come from {len(names)}."
        )
    for group in _label_groups(names):
        new = np.array([source in group for source in clips.sources])
        yield Round(tuple(group), np.flatnonzero(~new), np.flatnonzero(new))


def _label_groups(names: Sequence[str]) -> list[list[str]]:
    """Groups of names: each name alone, or several together if there are over MAX_ROUNDS."""
    count = min(len(names), MAX_ROUNDS)
    return [list(names[index::count]) for index in range(count)]


def _usable(found: Iterator[Round] | Sequence[Round]) -> list[Round]:
    usable = [one for one in found if len(one.train) >= 2 and len(one.probe)]
    if not usable:
        raise NotEnoughLabels("There are too few recordings to hold any out.")
    return usable
