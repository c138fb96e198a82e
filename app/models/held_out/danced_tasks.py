"""The segments of a library's dances, arranged for Perera's tensor: person, task, cycle.

Each step of a repeated sequence is a task ("salsa 1", "salsa 2", ...). Each repetition of the
sequence is a cycle. A sequence may begin at any of its steps, so the cycles of all clips of a
task are shifted until they begin with the same one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.segments.danced_cycles import DancedCycles
from app.numerics.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class DancedTasks:
    """n segments of dances.

    poses: (n, POSES, 13, 3) in the body frame, in body lengths; persons, tasks: (n,) labels;
    cycle: (n,) the number of times that the person did the task before this segment.
    """

    poses: FloatArray
    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    cycle: IntArray

    def __len__(self) -> int:
        return len(self.cycle)

    def part(self, chosen: BoolArray) -> DancedTasks:
        """The segments where `chosen` (n,) is true."""
        index = np.flatnonzero(chosen)
        who, what = (tuple(names[i] for i in index) for names in (self.persons, self.tasks))
        return DancedTasks(self.poses[index], who, what, self.cycle[index])


def arrange(
    clips: Sequence[DancedCycles], persons: Sequence[str | None], tasks: Sequence[str | None]
) -> DancedTasks:
    """Arrange the segments of all clips that have both labels.

    clips, persons, tasks: (clips,) each. A clip is left out if its number of segments in a cycle
    differs from that of most clips of its task.
    """
    poses: list[FloatArray] = []
    labels: list[tuple[str, str, int]] = []
    done: Counter[tuple[str, str]] = Counter()
    for task in sorted({what for what in tasks if what}):
        of_task = [i for i, what in enumerate(tasks) if what == task and persons[i]]
        if not of_task:
            continue
        for index, cycles in _in_phase(of_task, clips):
            person = str(persons[index])
            for cycle in cycles:
                names = (
                    [task] if len(cycle) == 1 else [f"{task} {n + 1}" for n in range(len(cycle))]
                )
                labels += [(person, name, done[person, task]) for name in names]
                poses += list(cycle)
                done[person, task] += 1
    who, what, cycle = zip(*labels, strict=True) if labels else ((), (), ())
    stacked = np.stack(poses) if poses else np.zeros((0, 0, 13, 3))
    return DancedTasks(stacked, who, what, np.array(cycle, dtype=np.int64))


def _in_phase(of_task: list[int], clips: Sequence[DancedCycles]) -> list[tuple[int, FloatArray]]:
    """The index and the cycles (c, m, ...) of each clip of a task, shifted to the first clip."""
    counts = Counter(clips[i].length for i in of_task)
    usual = max(counts, key=lambda length: (counts[length], -length))
    chosen = [i for i in of_task if clips[i].length == usual]
    reference = clips[chosen[0]].cycles().mean(axis=0)
    return [(i, _shifted(clips[i], reference)) for i in chosen]


def _shifted(clip: DancedCycles, reference: FloatArray) -> FloatArray:
    """(c, m, ...) the cycles of `clip`, shifted to be nearest to the `reference` cycle (m, ...)."""
    shifted = [clip.cycles(shift) for shift in range(clip.length)]
    distances = [
        np.square(cycles.mean(axis=0) - reference).sum() if len(cycles) else np.inf
        for cycles in shifted
    ]
    return shifted[int(np.argmin(distances))]
