"""DTW of queries with 350 real clips, compared with aeon, tslearn and dtaidistance.

Run: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 pytest -m bench -s tests/bench/test_dtw.py
Each library compares the 10 Hz features (82 columns) of dataset 2 with the same clips, in one
thread. The best CPU time of several rounds counts, in which the libraries take turns. dtaidistance
runs its C library with Euclidean cost: its totals must equal ours. aeon and tslearn only have the
squared cost, which is not more work. Searches use no band, so we measure without a band.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

import numpy as np
import pytest

from app.numerics.alignment.dtw import dtw_distances
from app.search.example.distances import FEATURES
from tests.bench.described_clips import described_clips
from tests.bench.page import Section

FIGURES = Section(
    "dtw",
    "DTW compared with other libraries",
    trials="each query against 350 real clips, one thread, best of some rounds",
)

pytestmark = pytest.mark.bench

ROUNDS = 5
QUERIES = 5
TARGET = 2.0
"""Least speed, relative to the fastest other library."""


@pytest.fixture(scope="module")
def sequences() -> list[np.ndarray]:
    clips = described_clips()
    return [
        arrays[FEATURES]
        for folder, arrays in zip(clips.folders, clips.arrays, strict=True)
        if folder == "bandai-namco-2"
    ]


@pytest.mark.filterwarnings("ignore")
def test_dtw_beside_its_peers(sequences: list[np.ndarray]) -> None:
    ways = _ways(sequences)
    queries = np.linspace(0, len(sequences) - 1, QUERIES).astype(int)
    for way in ways.values():
        way(0)  # compiles the code and fills the caches
    best = dict.fromkeys(ways, np.inf)
    for _ in range(ROUNDS):
        for name, way in ways.items():
            began = time.process_time()
            for query in queries:
                way(query)
            best[name] = min(best[name], (time.process_time() - began) / len(queries))
    FIGURES.print(f"\n{len(sequences)} clips, load {os.getloadavg()[0]:.1f}")
    for name, seconds in best.items():
        FIGURES.print(f"  {name:14}{1e3 * seconds:8.1f} ms  {seconds / best['ours']:6.2f} x ours")
    np.testing.assert_allclose(ways["ours"](3), ways["dtaidistance"](3), rtol=1e-4, atol=1e-3)
    assert min(s for name, s in best.items() if name != "ours") >= TARGET * best["ours"]


def _ways(sequences: list[np.ndarray]) -> dict[str, Callable[[int], np.ndarray]]:
    """Functions from the number of a query to its totals (350,), by library."""
    from aeon.distances import dtw_distance
    from dtaidistance import dtw_ndim
    from tslearn.metrics import dtw

    doubles = [np.ascontiguousarray(one, dtype=np.float64) for one in sequences]
    channels = [np.ascontiguousarray(one.T) for one in doubles]

    def by_tslearn(query: int) -> np.ndarray:
        a = doubles[query]
        return np.array([dtw(a, b) for b in doubles])

    def by_dtaidistance(query: int) -> np.ndarray:
        a = doubles[query]
        return np.array([dtw_ndim.distance_fast(a, b, inner_dist="euclidean") for b in doubles])

    return {
        "ours": lambda q: dtw_distances(sequences[q], sequences, per_step=False),
        "aeon": lambda q: np.array([dtw_distance(channels[q], b) for b in channels]),
        "tslearn": by_tslearn,
        "dtaidistance": by_dtaidistance,
    }
