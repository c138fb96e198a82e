"""Motion samples of invented persons and tasks: effects added up, some interaction, noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WIDTH = 60
"""Numbers in a sample; most models take any width."""

POSES = 2 * 39 + 2
"""Numbers in a sample that models of poses can read: two moments, turn and speed."""


@dataclass(frozen=True)
class FactorClips:
    samples: np.ndarray
    persons: list[str]
    tasks: list[str]
    takes: np.ndarray

    @property
    def labels(self) -> list[tuple[str, str]]:
        return list(zip(self.persons, self.tasks, strict=True))

    def where(self, chosen: np.ndarray) -> tuple[np.ndarray, list[str], list[str]]:
        index = np.flatnonzero(chosen)
        who, what = ([labels[i] for i in index] for labels in (self.persons, self.tasks))
        return self.samples[index], who, what


def factor_clips(
    persons: int = 5,
    tasks: int = 6,
    takes: int = 4,
    seed: int = 0,
    noise: float = 0.05,
    width: int = WIDTH,
) -> FactorClips:
    rng = np.random.default_rng(seed)
    who, what = 0.4 * rng.normal(size=(persons, width)), rng.normal(size=(tasks, width))
    both = 0.15 * rng.normal(size=(persons, tasks, width))
    p, t, k = (a.ravel() for a in np.indices((persons, tasks, takes)))
    samples = 1.0 + who[p] + what[t] + both[p, t] + noise * rng.normal(size=(len(p), width))
    return FactorClips(samples, [f"p{i}" for i in p], [f"t{i}" for i in t], k)
