"""Rounds that hold out clips (all of one recording together), whole tasks, or whole persons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum

import numpy as np

from app.models.folds import grouped_folds
from app.numerics.arrays import IntArray

FOLDS = 5
"""Number of parts into which clips, tasks and persons are each divided."""

MIN_LABELS = 3
"""With fewer tasks (or persons), none is held out: too few would remain in the training."""

MAX_PROBES = 400
"""Largest number of clips probed in one round; more cost time and hardly change the figures."""


class HeldOut(StrEnum):
    """The kind of thing that a round holds out."""

    CLIPS = "clips"
    TASKS = "tasks"
    PERSONS = "persons"


Round = tuple[HeldOut, IntArray, IntArray]
"""The kind of held-out thing; indices of the training clips; indices of the clips to probe."""


def rounds(
    persons: Sequence[str | None], tasks: Sequence[str | None], groups: Sequence[str]
) -> Iterator[Round]:
    """The rounds: first those that hold out clips, then tasks, then persons."""
    yield from _splits(HeldOut.CLIPS, grouped_folds(groups, FOLDS))
    for kind, labels in ((HeldOut.TASKS, tasks), (HeldOut.PERSONS, persons)):
        names = sorted({label for label in labels if label})
        if len(names) < MIN_LABELS:
            continue
        fold_of = {name: i % min(FOLDS, len(names)) for i, name in enumerate(names)}
        yield from _splits(kind, np.array([fold_of[label] if label else -1 for label in labels]))


def _splits(kind: HeldOut, fold: IntArray) -> Iterator[Round]:
    """A round for each fold; fold: (clips,), -1 for clips that are never probed."""
    for each in range(int(fold.max(initial=-1)) + 1):
        train, probe = np.flatnonzero(fold != each), np.flatnonzero(fold == each)
        if len(train) >= 2 and len(probe):
            # evenly spread, so that every part of the fold is probed
            chosen = np.linspace(0, len(probe) - 1, min(len(probe), MAX_PROBES))
            yield kind, train, probe[chosen.astype(np.int64)]
