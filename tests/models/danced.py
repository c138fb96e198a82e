"""Segments of invented dancers: poses by task and by person added up, each cycle a bit other."""

from __future__ import annotations

import numpy as np

from app.models.held_out.danced_tasks import DancedTasks


def danced_by(
    persons: int, tasks: int, cycles: int, *, own: float = 0.4, change: float = 0.1, seed: int = 0
) -> DancedTasks:
    """own: how persons differ, beside 1 for tasks; change: from cycle to cycle."""
    rng = np.random.default_rng(seed)
    p, t, c = (a.ravel() for a in np.indices((persons, tasks, cycles)))
    who, what = own * rng.normal(size=(persons, 4, 13, 3)), rng.normal(size=(tasks, 4, 13, 3))
    poses = who[p] + what[t] + change * rng.normal(size=(len(p), 4, 13, 3))
    return DancedTasks(poses, tuple(f"p{i}" for i in p), tuple(f"t{i}" for i in t), c)
