"""Motion shapes of invented persons and tasks, of a few factors that multiply."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH


@dataclass(frozen=True)
class InventedShapes:
    shapes: np.ndarray
    persons: list[str]
    tasks: list[str]

    def without(self, person: str, task: str) -> InventedShapes:
        keep = [(p, t) != (person, task) for p, t in zip(self.persons, self.tasks, strict=True)]
        rows = np.flatnonzero(keep)
        who, what = ([labels[i] for i in rows] for labels in (self.persons, self.tasks))
        return InventedShapes(self.shapes[rows], who, what)

    def cell(self, person: str, task: str) -> np.ndarray:
        labels = zip(self.persons, self.tasks, strict=True)
        return self.shapes[[label == (person, task) for label in labels]].mean(axis=0)


def invented_shapes(
    persons: int = 4, tasks: int = 6, takes: int = 2, *, rank: int = 3, noise: float = 0.01
) -> InventedShapes:
    """Every cell = (1, person's factors) x (1, task's factors) x shapes, with some noise."""
    rng = np.random.default_rng(0)
    who = np.hstack([np.ones((persons, 1)), 0.5 * rng.normal(size=(persons, rank))])
    what = np.hstack([np.ones((tasks, 1)), rng.normal(size=(tasks, rank))])
    core = 0.3 * rng.normal(size=(rank + 1, rank + 1, SHAPE_LENGTH))
    cells = np.einsum("pa,tb,abd->ptd", who, what, core)
    p, t, _ = (index.ravel() for index in np.indices((persons, tasks, takes)))
    shapes = cells[p, t] + noise * rng.normal(size=(len(p), SHAPE_LENGTH))
    shapes[:, -2], shapes[:, -1] = np.log(2.0), 0.0
    return InventedShapes(shapes, [f"p{i}" for i in p], [f"t{i}" for i in t])
