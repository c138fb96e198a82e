"""Folds for held-out figures. Files of one recording are always in the same fold.

A recording may be in a library twice (as BVH and as AMC); a model must not learn from one copy
and be judged on the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

import numpy as np

from app.numerics.arrays import IntArray


def recording_of(filename: str) -> str:
    """The name that files of one recording share: "cmu-bvh/02_01.bvh", "02_01.amc" -> "02_01"."""
    return PurePosixPath(filename.replace("\\", "/")).stem.casefold()


def grouped_folds(groups: Sequence[str], folds: int, *, seed: int = 0) -> IntArray:
    """(N,) fold of each item, 0..folds-1, the same for items of one group.

    Groups are shuffled by `seed`, then each goes to the fold that has the fewest items;
    the order of the items does not matter.
    """
    names = sorted(set(groups))
    sizes = dict.fromkeys(names, 0)
    for name in groups:
        sizes[name] += 1
    filled = np.zeros(folds, dtype=np.int64)
    fold_of: dict[str, int] = {}
    for index in np.random.RandomState(seed).permutation(len(names)):
        fold_of[names[index]] = int(np.argmin(filled))
        filled[fold_of[names[index]]] += sizes[names[index]]
    return np.array([fold_of[name] for name in groups], dtype=np.int64)
