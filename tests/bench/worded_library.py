"""Words, and the arrays that a fit reads, for the clips of a large library."""

from __future__ import annotations

import functools

import numpy as np
from sqlalchemy import delete, insert

from app.analysis.analyze import ANALYSIS_VERSION
from app.numerics.arrays import FloatArray
from app.services.training.training_set import NAMES
from app.store.database import tables as t
from app.store.database.blobs import to_blob
from app.store.store import Store
from tests.bench.large_library import VECTOR, Sample, many_clips, samples
from tests.real_clips import manifest

SPREAD = 0.05
"""Deviation of the noise, relative to that of a statistic, and in the units of the channels."""
STATISTICS, MOVED = "symbol_statistics", "symbol_means"
UNCHANGED_ARRAYS = tuple({*NAMES} - {VECTOR, STATISTICS, MOVED})
"""The other arrays that a fit reads."""
AT_ONCE = 500


@functools.lru_cache(maxsize=1)
def _words() -> dict[str, list[tuple[str, ...]]]:
    """Label sets of the manifest, by task."""
    found: dict[str, list[tuple[str, ...]]] = {}
    for row in manifest():
        found.setdefault(row["task"], []).append(tuple(row["words"].split()))
    return found


def disturbed(sample: Sample, rng: np.random.Generator) -> dict[str, FloatArray]:
    """The arrays of a clip that word models read, with noise."""
    spread = np.stack([one.arrays[STATISTICS] for one in samples()]).std(axis=0)
    statistics = sample.arrays[STATISTICS] + rng.normal(size=spread.shape) * spread * SPREAD
    means = sample.arrays[MOVED] + rng.normal(size=sample.arrays[MOVED].shape[1]) * SPREAD
    moved = {STATISTICS: statistics.astype(np.float32), MOVED: means.astype(np.float32)}
    return moved | {name: sample.arrays[name] for name in UNCHANGED_ARRAYS}


def describe(store: Store, count: int) -> None:
    """Give the `count` clips of a filled store the arrays that a fit reads, and words of people."""
    rng = np.random.default_rng(3)
    made = list(many_clips(count))
    for first in range(0, count, AT_ONCE):
        words, arrays = [], []
        for sample, clip in made[first : first + AT_ONCE]:
            said = _words()[sample.task]
            for position, word in enumerate(dict.fromkeys(said[rng.integers(len(said))])):
                words.append({"clip_id": clip.id, "word": word, "position": position})
            for name, array in disturbed(sample, rng).items():
                row = {"clip_id": clip.id, "name": name, "version": ANALYSIS_VERSION}
                arrays.append(row | to_blob(array))
        with store.write() as tx:
            ids = [clip.id for _, clip in made[first : first + AT_ONCE]]
            tx.execute(delete(t.clip_words).where(t.clip_words.c.clip_id.in_(ids)))
            tx.execute(insert(t.clip_words), words)
            tx.execute(insert(t.clip_arrays), arrays)
