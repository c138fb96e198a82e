"""Majorisation finds points for their distances, and agrees with scikit-learn's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from sklearn.manifold import smacof as reference

from app.numerics.mds import classical_mds
from app.numerics.smacof import raw_stress, smacof


def _distances(seed: int, count: int = 20, noise: float = 0.3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 4))
    bent = cdist(points, points) + noise * rng.random((count, count))
    made = (bent + bent.T) / 2
    np.fill_diagonal(made, 0.0)
    return made


def test_points_are_found_again_but_for_turns() -> None:
    points = np.random.default_rng(0).normal(size=(15, 3))
    found = smacof(cdist(points, points), 3)
    assert np.allclose(cdist(found, found), cdist(points, points), atol=1e-4)


@given(st.integers(0, 50), st.integers(1, 3))
@settings(max_examples=15, deadline=None)
def test_stress_is_no_worse_than_that_of_classical_scaling(seed: int, dimensions: int) -> None:
    wanted = _distances(seed)
    assert raw_stress(smacof(wanted, dimensions), wanted) <= raw_stress(
        classical_mds(wanted, dimensions), wanted
    )


def test_it_comes_as_low_as_the_reference() -> None:
    wanted = _distances(3)
    start = classical_mds(wanted, 2)
    theirs, _ = reference(
        wanted,
        n_components=2,
        init=start,
        n_init=1,
        max_iter=300,
        eps=1e-6,
        normalized_stress=False,
    )
    ours = raw_stress(smacof(wanted, 2), wanted)
    assert ours == pytest.approx(raw_stress(theirs, wanted), rel=0.02)


def test_few_points_and_equal_points_are_no_trouble() -> None:
    assert smacof(np.zeros((1, 1)), 2).shape == (1, 2)
    assert np.isfinite(smacof(np.zeros((4, 4)), 2)).all()
