"""The fused distance: continuous, nothing to itself, and led by what lies between."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.search.example.fusion import DTW_WEIGHT, MAX_DETOUR, Neighborhood
from tests.search.fused import fused_distances


@given(n=st.integers(1, 40), seed=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_a_fused_distance_is_at_least_its_parts_and_zero_only_for_the_query(
    n: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    vectors, warped = rng.normal(size=(n, 8)), rng.uniform(0.1, 1.0, size=n)
    query, warped[0] = vectors[0].copy(), 0.0
    found = fused_distances(query, vectors, warped)
    straight = np.linalg.norm(vectors - query, axis=1) + DTW_WEIGHT * warped
    assert found[0] == 0.0
    assert (found >= straight - 1e-9).all()
    assert (found <= (1 + MAX_DETOUR) * straight + 1e-9).all()


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_the_order_of_the_clips_does_not_matter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vectors, warped = rng.normal(size=(30, 8)), rng.uniform(size=30)
    order = rng.permutation(30)
    query = rng.normal(size=8)
    one = fused_distances(query, vectors, warped)
    other = fused_distances(query, vectors[order], warped[order])
    np.testing.assert_allclose(other, one[order], rtol=1e-9)


def test_a_path_of_intermediate_clips_leads_to_the_same_task() -> None:
    """Two tasks side by side, manner along both: the own ones come before the other's nearer."""
    straight, fused = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        points = 0.3 * rng.normal(size=(80, 8))
        points[:, 0] = rng.uniform(0, 2, size=80)
        points[40:, 1] += 1.3
        others, is_own = points[1:], np.arange(1, 80) < 40
        distances = np.linalg.norm(others - points[0], axis=1)
        straight.append(is_own[np.argsort(distances)[:39]].mean())
        found = fused_distances(points[0], others, np.zeros(79))
        fused.append(is_own[np.argsort(found)[:39]].mean())
    assert np.mean(fused) > np.mean(straight) + 0.04


def test_a_little_noise_changes_distances_by_less_than_a_hundredth() -> None:
    rng = np.random.default_rng(7)
    vectors, query = rng.normal(size=(120, 16)), rng.normal(size=16)
    before = fused_distances(query, vectors, np.zeros(120))
    after = fused_distances(query + 1e-4 * rng.normal(size=16), vectors, np.zeros(120))
    assert np.abs(after / before - 1).max() < 0.01


def test_zero_clips_and_one_clip_are_ranked() -> None:
    assert fused_distances(np.ones(4), np.zeros((0, 4)), np.zeros(0)).shape == (0,)
    alone = fused_distances(np.ones(4), np.zeros((1, 4)), np.zeros(1))
    assert 2.0 <= alone[0] <= 2.0 * (1 + MAX_DETOUR)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_without_warping_it_is_a_lower_bound_and_rows_are_independent(seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, vectors, warped = rng.normal(size=8), rng.normal(size=(40, 8)), rng.uniform(size=40)
    known, every = Neighborhood.of(query, vectors).seen_from(0), np.arange(40)
    found = known.distances(every, warped)
    assert (known.distances(every, np.zeros(40)) <= found).all()
    some = rng.permutation(40)[:7]
    assert known.distances(some, warped[some]).tolist() == found[some].tolist()


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_at_any_tempo_distances_only_fall_and_bounds_stay_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, vectors, warped = rng.normal(size=8), rng.normal(size=(40, 8)), rng.uniform(size=40)
    paced = np.where(rng.uniform(size=40) < 0.2, np.inf, rng.uniform(0, 4, size=40))
    windows = np.where(rng.uniform(size=40) < 0.2, np.inf, rng.uniform(0.5, 4, size=40))
    contained = np.where(rng.uniform(size=40) < 0.5, np.inf, rng.uniform(size=40))
    timed, every = Neighborhood.of(query, vectors).seen_from(0), np.arange(40)
    known = timed.nearer(paced, windows).contained(contained)
    found = known.distances(every, warped)
    assert (known.distances(every, np.zeros(40)) <= found).all()
    assert (found <= timed.distances(every, warped)).all()
    assert (found > 0).all()
    unknown = np.full(40, np.inf)
    same = timed.nearer(unknown, unknown).contained(unknown).distances(every, warped)
    assert same.tolist() == timed.distances(every, warped).tolist()
