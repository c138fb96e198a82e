from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from sklearn.isotonic import IsotonicRegression

from app.numerics.isotonic import rising_means


@given(st.lists(st.tuples(st.integers(-20, 20), st.integers(0, 3)), min_size=1, max_size=60))
def test_pools_are_those_of_scikit_learn(points: list[tuple[int, int]]) -> None:
    x, y = np.array(points, dtype=np.float64).T
    means, levels = rising_means(x, y)
    assert (np.diff(means) > 0).all()
    assert (np.diff(levels) > 0).all()
    fitted = IsotonicRegression().fit(x, y).predict(x)
    np.testing.assert_allclose(np.unique(fitted.round(9)), levels.round(9), atol=1e-8)
