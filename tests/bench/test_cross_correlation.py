"""D_xcorr of one motion and many others: our batch compared with numpy.correlate in a loop.

Run: pytest -m bench -s tests/bench/test_cross_correlation.py
Lengths are distributed like those of real clips: half between 3 and 7 seconds, some a minute.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest

from app.analysis.descriptors.motion_volume import cross_correlations
from app.numerics.arrays import FloatArray
from tests.bench.page import Section

FIGURES = Section(
    "cross_correlation",
    "D_xcorr of one motion against many",
    trials="one batch against a loop of `numpy.correlate`, in turns, at each number of volumes",
)

pytestmark = pytest.mark.bench

REPEATS = 5


def _volumes(count: int) -> tuple[FloatArray, list[FloatArray]]:
    """rhos (count, 13) and epsilons (frames,), all of unit length and without negative values."""
    rng = np.random.default_rng(0)
    rhos = 1 + 0.1 * rng.random((count, 13))
    lengths = np.clip(np.exp(rng.normal(np.log(140), 0.6, size=count)), 20, 1900).astype(int)
    epsilons = [1 + 0.1 * rng.random(length) for length in lengths]
    unit = [epsilon / np.linalg.norm(epsilon) for epsilon in epsilons]
    return rhos / np.linalg.norm(rhos, axis=1, keepdims=True), unit


def _one_by_one(
    rho: FloatArray, epsilon: FloatArray, rhos: FloatArray, epsilons: list[FloatArray]
) -> FloatArray:
    return np.array(
        [
            2 * np.correlate(rho, a, "full").max() + np.correlate(epsilon, b, "full").max()
            for a, b in zip(rhos, epsilons, strict=True)
        ]
    )


def _best(work: Callable[[], FloatArray]) -> tuple[float, FloatArray]:
    took = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        answer = work()
        took.append(time.perf_counter() - began)
    return min(took), answer


@pytest.mark.parametrize("count", [500, 10_000])
def test_the_batch_is_exact_and_faster(count: int) -> None:
    rhos, epsilons = _volumes(count)
    ratios = []
    for query in range(0, count, count // 5):
        asked = (rhos[query], epsilons[query], rhos, epsilons)
        loop, expected = _best(lambda asked=asked: _one_by_one(*asked))
        batch, found = _best(lambda asked=asked: cross_correlations(*asked))
        np.testing.assert_allclose(found, expected, atol=1e-12)
        ratios.append(loop / batch)
        FIGURES.print(
            f"\n{count:6} volumes, query of {len(epsilons[query]):4} frames:"
            f" loop {1e3 * loop:7.1f} ms, batch {1e3 * batch:6.1f} ms, {ratios[-1]:.1f}x",
            end="",
        )
    FIGURES.print(f"\n{count:6} volumes: {np.median(ratios):.1f}x (median)")
    assert np.median(ratios) > 1.0
