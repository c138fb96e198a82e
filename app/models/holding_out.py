"""What is held out in turn: clips (all of one recording together), whole tasks, whole persons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum

import numpy as np

from app.models.folds import grouped_folds
from app.numerics.arrays import IntArray

FOLDS = 5
"""Parts that clips, tasks and persons are each dealt into."""

MIN_LABELS = 3
"""With fewer tasks (or persons) none is held out: what remains would be no choice."""

MAX_PROBES = 400
"""Clips probed in one round; more would cost time and tell nothing new."""


class Held(StrEnum):
    """What a round holds out."""

    CLIPS = "clips"
    TASKS = "tasks"
    PERSONS = "persons"


Round = tuple[Held, IntArray, IntArray]
"""What is held out; indices of the training clips; indices of the clips to probe."""


def rounds(
    persons: Sequence[str | None], tasks: Sequence[str | None], groups: Sequence[str]
) -> Iterator[Round]:
    """Each round: clips held out in turn, then tasks, then persons."""
    yield from _splits(Held.CLIPS, grouped_folds(groups, FOLDS))
    for held, labels in ((Held.TASKS, tasks), (Held.PERSONS, persons)):
        names = sorted({label for label in labels if label})
        if len(names) < MIN_LABELS:
            continue
        deal = {name: i % min(FOLDS, len(names)) for i, name in enumerate(names)}
        yield from _splits(held, np.array([deal[label] if label else -1 for label in labels]))


def _splits(held: Held, fold: IntArray) -> Iterator[Round]:
    for each in range(int(fold.max(initial=-1)) + 1):
        train, probe = np.flatnonzero(fold != each), np.flatnonzero(fold == each)
        if len(train) >= 2 and len(probe):
            chosen = np.linspace(0, len(probe) - 1, min(len(probe), MAX_PROBES))
            yield held, train, probe[chosen.astype(np.int64)]
