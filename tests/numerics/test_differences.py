from __future__ import annotations

import numpy as np
import pytest

from app.numerics.differences import central_differences, point_reflected


@pytest.mark.parametrize("count", [2, 3, 50])
@pytest.mark.parametrize("rest", [(), (13, 3)])
@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_differences_are_those_of_numpy(count: int, rest: tuple[int, ...], kind: str) -> None:
    values = np.random.default_rng(count).normal(size=(count, *rest)).astype(kind)
    found = central_differences(values)
    assert found.dtype == values.dtype
    np.testing.assert_array_equal(found, np.gradient(values, axis=0))


@pytest.mark.parametrize("count", [1, 2, 9, 50])
@pytest.mark.parametrize("reach", [0, 1, 8, 9, 120])
def test_continuations_are_those_of_numpy(count: int, reach: int) -> None:
    values = np.random.default_rng(count).normal(size=(count, 3))
    expected = np.pad(values, ((reach, reach), (0, 0)), mode="reflect", reflect_type="odd")
    np.testing.assert_array_equal(point_reflected(values, reach), expected)
