"""Motion volumes, and the two distances of the paper."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_volume import (
    MAX_CROSS_CORRELATION,
    compression_ratio,
    cross_correlations,
    decompose,
    motion_volume,
    self_similarity,
    warping_distances,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking, waving


@pytest.mark.parametrize("q", [1, 2])
def test_a_self_similarity_matrix_holds_the_distances_of_joints(q: int) -> None:
    points = np.random.default_rng(0).normal(size=(3, 13, 3))
    found = self_similarity(points, q=q)
    for f, i, j in [(0, 1, 4), (2, 12, 0), (1, 5, 5)]:
        difference = np.abs(points[f, i] - points[f, j])
        assert found[f, i, j] == pytest.approx((difference**q).sum() ** (1 / q))


def test_a_threshold_leaves_who_is_near_whom() -> None:
    points = np.random.default_rng(1).normal(size=(2, 5, 3))
    near = self_similarity(points, threshold=1.5)
    np.testing.assert_array_equal(near, (self_similarity(points) <= 1.5).astype(float))


def test_another_norm_is_refused() -> None:
    with pytest.raises(ValueError, match="q must be"):
        self_similarity(np.zeros((1, 2, 3)), q=3)


@pytest.mark.parametrize("q", [1, 2])
def test_position_heading_and_size_change_nothing(q: int) -> None:
    body = walking(turn=0.5)
    one = decompose(body_track(motion_of(body)), q=q)
    moved = turned_about_y(body, 2.0) * 1.7 + [3.0, 0.5, -4.0]
    other = decompose(body_track(motion_of(moved)), q=q)
    assert other.weight == pytest.approx(one.weight, rel=1e-4)
    np.testing.assert_allclose(other.primary, one.primary, atol=1e-5)
    np.testing.assert_allclose(other.secondary, one.secondary, atol=1e-5)


def test_the_paper_s_few_iterations_suffice() -> None:
    found = decompose(body_track(motion_of(walking())))
    assert found.converged
    assert found.errors[5] - found.errors[-1] < 1e-4


def slow_correlation(a: FloatArray, b: FloatArray) -> float:
    """max C(a, b) of equation 6, the shorter padded with zeros to the length of the longer."""
    length = max(len(a), len(b))
    a, b = (np.pad(vector, (0, length - len(vector))) for vector in (a, b))
    return max(
        float(sum(a[i + lag] * b[i] for i in range(length) if 0 <= i + lag < length))
        for lag in range(1 - length, length)
    )


def slow_warping(a: FloatArray, b: FloatArray) -> float:
    """DTW(a, b) of equation 7: the least sum of |a_i - b_j| along a path from end to end."""
    total = np.full((len(a) + 1, len(b) + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(len(a)):
        for j in range(len(b)):
            before = min(total[i, j], total[i, j + 1], total[i + 1, j])
            total[i + 1, j + 1] = abs(a[i] - b[j]) + before
    return float(total[-1, -1])


def test_both_measures_sum_over_the_three_vectors_as_printed() -> None:
    bodies = [walking(seconds=1.5), walking(steps_hz=1.3, turn=1.0, seconds=1.0), waving()]
    found = [decompose(body_track(motion_of(body))) for body in bodies]
    vectors = [(f.primary, f.primary, f.secondary) for f in found]
    rhos, epsilons = np.array([f.primary for f in found]), [f.secondary for f in found]
    for query in range(len(found)):
        likeness = cross_correlations(rhos[query], epsilons[query], rhos, epsilons)
        distances = warping_distances(rhos[query], epsilons[query], rhos, epsilons)
        for other in range(len(found)):
            pairs = list(zip(vectors[query], vectors[other], strict=True))
            assert likeness[other] == pytest.approx(sum(slow_correlation(a, b) for a, b in pairs))
            assert distances[other] == pytest.approx(
                sum(slow_warping(a, b) for a, b in pairs), rel=1e-5, abs=1e-6
            )


def test_both_measures_find_the_motion_itself_first() -> None:
    bodies = [walking(), walking(steps_hz=1.3, turn=1.0), waving(), standing(100)]
    found = [decompose(body_track(motion_of(body))) for body in bodies]
    rhos, epsilons = np.array([f.primary for f in found]), [f.secondary for f in found]
    likeness = cross_correlations(rhos[0], epsilons[0], rhos, epsilons)
    distances = warping_distances(rhos[0], epsilons[0], rhos, epsilons)
    assert likeness[0] == pytest.approx(MAX_CROSS_CORRELATION)
    assert (likeness <= MAX_CROSS_CORRELATION + 1e-9).all()
    assert distances[0] == 0.0
    assert likeness.argmax() == distances.argmin() == 0


def test_rho_counts_twice() -> None:
    a, b = np.array([0.6, 0.8]), np.array([1.0, 0.0])
    assert cross_correlations(a, a, b[None], [b])[0] == pytest.approx(3 * 0.8)
    # warping a onto b: the path (0,0), (0,0)-(1,1) costs |.6 - 1| + |.8 - 0|
    assert warping_distances(a, a, b[None], [b])[0] == pytest.approx(3 * 1.2)


def test_stillness_has_a_volume() -> None:
    track = body_track(motion_of(standing(2)))
    assert motion_volume(track).shape == (13, 13, 2)
    np.testing.assert_allclose(decompose(track).secondary, np.sqrt([0.5, 0.5]))


def test_the_factors_are_small_beside_the_positions() -> None:
    frames = [90, 400, 1000]
    kept, positions = sum(13 + t for t in frames), sum(3 * 13 * t for t in frames)
    assert compression_ratio(frames) == pytest.approx(kept / positions)
    with pytest.raises(ValueError, match="nothing to compress"):
        compression_ratio([])
