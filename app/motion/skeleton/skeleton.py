"""The skeleton: the names, parents and offsets of joints."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A tree of joints. Each joint comes after its parent.

    names: (joints,). parents: (joints,) int, -1 for a root. offsets: (joints, 3) from the parent to
    the joint at rest, in the unit and axes of the file. end_parents: (ends,) the joint of each end
    site, which is the end of a bone without a joint. end_offsets: (ends, 3) from this joint.
    """

    names: tuple[str, ...]
    parents: IntArray
    offsets: FloatArray
    end_parents: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    end_offsets: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    def __len__(self) -> int:
        return len(self.names)

    def children(self, joint: int) -> list[int]:
        """The indices of the joints whose parent is `joint`, in the order of the file."""
        return [int(child) for child in np.flatnonzero(self.parents == joint)]
