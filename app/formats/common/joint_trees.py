"""Reads the parents of joints from arrays, checks them, and puts parents before children.

parents: (joints,) int, -1 for a root.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.formats.common.failures import unreadable_at
from app.numerics.arrays import IntArray

SMPL_ROOT = 2**32 - 1
"""The value -1 in the unsigned integers of SMPL's `kintree_table`."""


def parents_of(array: NDArray[Any], key: str, names: Sequence[str]) -> IntArray:
    """(joints,) the parents; -1 for a root.

    array: (joints,) or, as SMPL's `kintree_table`, (2, joints) with the parents first. A joint that
    is its own parent is a root. key: the name of the array, for errors. Raises Unreadable with the
    joint.
    """
    row = array[0] if array.ndim == 2 and len(array) == 2 else array
    if row.shape != (len(names),) or array.dtype.kind not in "iu":
        shape = "x".join(map(str, array.shape)) or "one"
        raise unreadable_at(key, f"expected {len(names)} integers, found {shape} {array.dtype}")
    parents = np.full(len(names), -1, dtype=np.int64)
    for joint, parent in enumerate(row.tolist()):
        is_root = parent in (-1, SMPL_ROOT, joint)
        if not is_root and not 0 <= parent < len(names):
            found = f"expected -1 or a joint below {len(names)} in {key}, found {parent}"
            raise unreadable_at(f"joint {joint} ({names[joint]})", found)
        parents[joint] = -1 if is_root else parent
    _refuse_circles(parents, names, key)
    return parents


def in_tree_order(parents: IntArray) -> IntArray:
    """(joints,) indices that put every joint after its parent and otherwise keep the order."""
    if (parents < np.arange(len(parents))).all():
        return np.arange(len(parents))
    return np.argsort(_depths(parents), kind="stable")


def _depths(parents: IntArray) -> IntArray:
    """(joints,) the steps to the root; for joints on a circle, the number of joints."""
    depths = np.zeros(len(parents), dtype=np.int64)
    above = parents.copy()
    while (climbing := above >= 0).any() and depths.max(initial=0) < len(parents):
        depths[climbing] += 1
        above[climbing] = parents[above[climbing]]
    return depths


def _refuse_circles(parents: IntArray, names: Sequence[str], key: str) -> None:
    joint = int(np.argmax(_depths(parents)))
    if _depths(parents)[joint] >= len(parents):
        where = f"joint {joint} ({names[joint]})"
        raise unreadable_at(where, f"expected a tree, found that it is its own ancestor in {key}")
