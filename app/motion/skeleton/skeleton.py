"""The skeleton: joint names, parents and offsets, parents before children."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A tree of joints, each after its parent.

    names: (joints,); parents: (joints,) int, -1 for a root;
    offsets: (joints, 3) from parent to joint at rest, in the file's unit and axes;
    end_parents: (ends,) joint that an end site hangs on; end_offsets: (ends, 3).
    """

    names: tuple[str, ...]
    parents: IntArray
    offsets: FloatArray
    end_parents: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    end_offsets: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    def __len__(self) -> int:
        return len(self.names)

    def children(self, joint: int) -> list[int]:
        """Indices of the joints whose parent is `joint`, in file order."""
        return [int(child) for child in np.flatnonzero(self.parents == joint)]
