"""Rounds that hold out clips (all of one recording together), whole tasks, or whole persons."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from enum import StrEnum

import numpy as np

from app.models.folds import grouped_folds
from app.numerics.arrays import IntArray

FOLDS = 5
"""Number of parts into which clips, tasks and persons are each divided."""

MIN_LABELS = 3
"""With fewer tasks (or persons), none is held out: too few would remain in the training."""

MIN_ORDERED = 4
"""Takes of a person at a task, of which one is held out and the one next to it is left out."""

MAX_PROBES = 400
"""Largest number of clips probed in one round; more cost time and hardly change the figures."""


class HeldOut(StrEnum):
    """The kind of thing that a round holds out."""

    CLIPS = "clips"
    TASKS = "tasks"
    PERSONS = "persons"
    STRANGERS = "persons and tasks"
    FAR = "far takes"


Round = tuple[HeldOut, IntArray, IntArray]
"""The kind of held-out thing; indices of the training clips; indices of the clips to probe."""


def rounds(
    persons: Sequence[str | None], tasks: Sequence[str | None], groups: Sequence[str]
) -> Iterator[Round]:
    """The rounds: first those that hold out clips, then tasks, then persons."""
    yield from _splits(HeldOut.CLIPS, grouped_folds(groups, FOLDS))
    for kind, labels in ((HeldOut.TASKS, tasks), (HeldOut.PERSONS, persons)):
        yield from _splits(kind, _fold_of_labels(labels))


def rounds_of_strangers(
    persons: Sequence[str | None], tasks: Sequence[str | None]
) -> Iterator[Round]:
    """Rounds that hold out persons and tasks at once: the probes are strangers at new tasks."""
    who, what = _fold_of_labels(persons), _fold_of_labels(tasks)
    for each in range(min(int(who.max(initial=-1)), int(what.max(initial=-1))) + 1):
        train = np.flatnonzero((who != each) & (what != each))
        probe = np.flatnonzero((who == each) & (what == each))
        if len(train) >= 2 and len(probe):
            yield HeldOut.STRANGERS, train, _spread(probe)


def rounds_by_distance(
    persons: Sequence[str | None], tasks: Sequence[str | None], groups: Sequence[str]
) -> Iterator[Round]:
    """Rounds that hold out takes that are far from those of the training.

    In the order of their names, the last fifth of the takes of each person at each task are the
    probes, and the fifth before them is left out; then the same from the other end. A neighbor of
    a take was often recorded in the same minute, and is more like it than a take of another day.
    Only persons with MIN_ORDERED takes of a task have probes.
    """
    cells: dict[tuple[str, str], list[int]] = {}
    for index, (person, task) in enumerate(zip(persons, tasks, strict=True)):
        if person and task:
            cells.setdefault((person, task), []).append(index)
    last, first = np.zeros(len(groups), dtype=bool), np.zeros(len(groups), dtype=bool)
    near_last, near_first = last.copy(), first.copy()
    for clips in cells.values():
        if len({groups[i] for i in clips}) < MIN_ORDERED:
            continue
        ordered = sorted(clips, key=lambda i: _natural(groups[i]))
        fifth = len(clips) // FOLDS or 1
        last[ordered[-fifth:]] = first[ordered[:fifth]] = True
        near_last[ordered[-2 * fifth :]] = near_first[ordered[: 2 * fifth]] = True
    for probe, near in ((last, near_last), (first, near_first)):
        if probe.any() and (~near).sum() >= 2:
            yield HeldOut.FAR, np.flatnonzero(~near), _spread(np.flatnonzero(probe))


def _natural(name: str) -> list[tuple[int, str]]:
    """The key that sorts take 10 after take 9."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", name)]


def _fold_of_labels(labels: Sequence[str | None]) -> IntArray:
    """(clips,) the fold of each label; -1 without a label, and with fewer than MIN_LABELS."""
    names = sorted({label for label in labels if label})
    if len(names) < MIN_LABELS:
        return np.full(len(labels), -1)
    fold_of = {name: i % min(FOLDS, len(names)) for i, name in enumerate(names)}
    return np.array([fold_of[label] if label else -1 for label in labels], dtype=np.int64)


def _splits(kind: HeldOut, fold: IntArray) -> Iterator[Round]:
    """A round for each fold; fold: (clips,), -1 for clips that are never probed."""
    for each in range(int(fold.max(initial=-1)) + 1):
        train, probe = np.flatnonzero(fold != each), np.flatnonzero(fold == each)
        if len(train) >= 2 and len(probe):
            yield kind, train, _spread(probe)


def _spread(probe: IntArray) -> IntArray:
    """At most MAX_PROBES of the probes (n,), evenly spread, so that every part is probed."""
    chosen = np.linspace(0, len(probe) - 1, min(len(probe), MAX_PROBES))
    return np.asarray(probe[chosen.astype(np.int64)])
