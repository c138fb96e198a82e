"""Motions brought to one course of time: each task's takes onto the task's mean.

Gait cycles are aligned where they are cut (app.motion.gait). Of other tasks one take hurries
where another lingers, so that moments of the same number are not the same moment; means of them
smear, and what is a matter of timing looks like a matter of style. Every motion is warped onto
the mean of its task by dynamic time warping within a narrow band, and the mean taken again. A
probe, whose task is not known, is warped onto each task's mean when it is held against it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from app.numerics.arrays import FloatArray

BAND = 0.2
"""Of the length, by which a moment may be moved; what is aligned already stays as it is."""

ROUNDS = 2
"""Of warping onto the mean and taking the mean of what was warped."""

RELUCTANCE = 0.1
"""Cost of a step that holds one of the two, beside the mean distance of two moments: without it
motions would be warped by their noise."""


@dataclass(frozen=True, slots=True)
class Courses:
    """tasks: sorted labels; means: (tasks, moments, d), onto which motions of each are warped."""

    tasks: tuple[str, ...]
    means: FloatArray

    def onto(self, motions: FloatArray, task: int) -> FloatArray:
        """`motions` (n, moments, d) warped onto the mean of a task."""
        return warped(motions, self.means[task])

    def aligned(self, motions: FloatArray, tasks: Sequence[str | None]) -> FloatArray:
        """(n, moments, d): each of `motions` onto the mean of its own task, where it has one."""
        out = np.array(motions, dtype=np.float64)
        for number, name in enumerate(self.tasks):
            own = np.flatnonzero([task == name for task in tasks])
            if len(own):
                out[own] = self.onto(out[own], number)
        return out


def fit_courses(motions: FloatArray, tasks: Sequence[str | None]) -> Courses:
    """The means of `motions` (n, moments, d) by task, each warped onto them ROUNDS times."""
    names = tuple(sorted({task for task in tasks if task}))
    means = np.zeros((len(names), *np.shape(motions)[1:]))
    for number, name in enumerate(names):
        own = np.asarray(motions, dtype=np.float64)[[task == name for task in tasks]]
        means[number] = own.mean(axis=0)
        for _ in range(ROUNDS):
            means[number] = warped(own, means[number]).mean(axis=0)
    return Courses(names, means)


def warped(motions: FloatArray, reference: FloatArray) -> FloatArray:
    """`motions` (n, moments, d) in the course of `reference` (moments, d): at each of its moments
    the mean of what the cheapest path within BAND holds against it."""
    motions = np.asarray(motions, dtype=np.float64)
    squares = (motions**2).sum(-1)[:, :, None] + (reference**2).sum(-1)
    cost = np.sqrt(np.maximum(squares - 2 * motions @ reference.T, 0.0))
    held = np.zeros_like(cost)
    for number, each in enumerate(cost):
        for own, other in _path(each.tolist(), RELUCTANCE * float(each.mean())):
            held[number, own, other] = 1.0
    held /= held.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("nij,nid->njd", held, motions))


def _path(cost: list[list[float]], reluctance: float) -> list[tuple[int, int]]:
    """The cells of the cheapest path through cost (m, m), from its end.

    Plain numbers: tables of a few hundred cells are walked faster so than by arrays.
    """
    moments = len(cost)
    reach = max(1, int(BAND * moments))
    total = [[inf] * (moments + 1) for _ in range(moments + 1)]
    total[0][0] = 0.0
    for i, row in enumerate(cost):
        above, here = total[i], total[i + 1]
        for j in range(max(0, i - reach), min(moments, i + reach + 1)):
            here[j + 1] = row[j] + min(above[j], above[j + 1] + reluctance, here[j] + reluctance)
    path = [(moments - 1, moments - 1)]
    while path[-1] != (0, 0):
        i, j = path[-1]
        ways = (
            (total[i][j], (i - 1, j - 1)),
            (total[i][j + 1] + reluctance, (i - 1, j)),
            (total[i + 1][j] + reluctance, (i, j - 1)),
        )
        path.append(min(ways)[1])
    return path
