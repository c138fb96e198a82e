"""The mean motion of each task, onto which takes of the task are warped for recognition.

Gait cycles are aligned where they are cut (app.motion.frame.gait). Takes of other tasks are warped
onto the mean of their task; see app.numerics.alignment.group_warping. The task of a probe is not
known. So it is warped onto the mean of each task with which it is compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.alignment.group_warping import group_means, means_of_warped, warped
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class TaskMeans:
    """The mean motion of each task.

    tasks: (T,) sorted labels; means: (T, moments, d).
    """

    tasks: tuple[str, ...]
    means: FloatArray

    def onto(self, motions: FloatArray, task: str) -> FloatArray:
        """`motions` (n, moments, d) warped onto the mean of `task`, which must be known."""
        return warped(motions, self.means[self.tasks.index(task)])

    def aligned(self, motions: FloatArray, tasks: Sequence[str | None]) -> FloatArray:
        """(n, moments, d) `motions` (n, moments, d), each warped onto the mean of its own task.

        tasks: (n,). A motion stays as it is if its task is None or not among `self.tasks`.
        """
        out = np.array(motions, dtype=np.float64)
        known, group = _groups(tasks, self.tasks)
        out[known] = warped(out[known], self.means[group])
        return out


def fit_task_means(motions: FloatArray, tasks: Sequence[str | None]) -> TaskMeans:
    """The means of `motions` (n, moments, d) by task; motions without a task are left out.

    tasks: (n,).
    """
    names = tuple(sorted({task for task in tasks if task}))
    known, group = _groups(tasks, names)
    own = np.asarray(motions, dtype=np.float64)[known]
    if not len(own):
        return TaskMeans((), own)
    return TaskMeans(names, means_of_warped(own, group, group_means(own, group), warped))


def _groups(tasks: Sequence[str | None], names: Sequence[str]) -> tuple[IntArray, IntArray]:
    """(k,) indices of the `tasks` (n,) that are among `names`, and (k,) their index in `names`."""
    known = [row for row, task in enumerate(tasks) if task in names]
    return np.array(known, dtype=np.int64), np.array(
        [names.index(str(tasks[row])) for row in known], dtype=np.int64
    )
