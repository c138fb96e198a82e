"""All distances of a batch against the obvious subtraction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.numerics import euclidean
from app.numerics.arrays import FloatArray
from app.numerics.euclidean import distances, squared_distances, squared_lengths


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_distances_are_those_of_subtraction(scale: float) -> None:
    rng = np.random.default_rng(1)
    rows = (scale * rng.normal(size=(7, 20))).astype(np.float32)
    others = (scale * rng.normal(size=(50, 20))).astype(np.float32)
    expected = np.linalg.norm(rows[:, None].astype(float) - others[None], axis=2)
    found = distances(rows, others, squared_lengths(others))
    np.testing.assert_allclose(found, expected, rtol=1e-5)


@pytest.mark.parametrize("pairs_at_once", [3, 10_000])
def test_close_rows_keep_their_digits_and_equal_rows_have_distance_zero(
    monkeypatch: pytest.MonkeyPatch, pairs_at_once: int
) -> None:
    rng = np.random.default_rng(2)
    monkeypatch.setattr(euclidean, "MAX_RECOMPUTED_PAIRS", pairs_at_once)
    rows = (100 + rng.normal(size=(4, 20))).astype(np.float32)
    near = rows + rng.normal(scale=1e-3, size=rows.shape).astype(np.float32)
    others = np.concatenate([rows, near])
    found = distances(rows, others, squared_lengths(others))
    assert np.diag(found).tolist() == [0.0] * 4
    expected = np.linalg.norm(rows.astype(float) - near, axis=1)
    np.testing.assert_allclose(np.diag(found[:, 4:]), expected, rtol=1e-4)


def test_empty_tables_have_empty_distances() -> None:
    nothing = np.zeros((0, 3), dtype=np.float32)
    assert distances(np.ones((2, 3), np.float32), nothing, squared_lengths(nothing)).shape == (2, 0)


@pytest.mark.parametrize(
    ("left", "right"),
    [((9, 5), (4, 5)), ((3, 9, 5), (3, 4, 5)), ((3, 9, 5), (4, 5)), ((2, 1, 9, 5), (3, 4, 5))],
)
def test_tables_of_many_are_those_of_each(left: tuple[int, ...], right: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    rows, others = rng.normal(size=left), rng.normal(size=right)
    others[..., :2, :] = rows[..., :2, :] if len(left) == len(right) else others[..., :2, :]
    found = squared_distances(rows, others)
    expected = np.square(rows[..., :, None, :] - others[..., None, :, :]).sum(axis=-1)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@given(st.integers(1, 6), st.floats(-6, 6), st.floats(-12, 0))
def test_double_precision_keeps_its_digits_wherever_the_rows_are(
    dimensions: int, magnitude: float, apart: float
) -> None:
    rng = np.random.default_rng(dimensions)
    rows = 10**magnitude * (1.0 + rng.normal(size=(5, dimensions)))
    others = rows + 10 ** (magnitude + apart) * rng.normal(size=rows.shape)
    found = squared_distances(rows, np.concatenate([rows, others]))
    assert np.diag(found).tolist() == [0.0] * 5
    assert (found >= 0).all()
    by_subtraction: FloatArray = np.square(rows - others).sum(axis=1)
    np.testing.assert_allclose(np.diag(found[:, 5:]), by_subtraction, rtol=1e-6)


def test_the_result_has_the_wider_type() -> None:
    single, double = np.ones((2, 3), np.float32), np.zeros((4, 3))
    assert squared_distances(single, single).dtype == np.float32
    assert squared_distances(single, double).dtype == np.float64
    assert squared_distances(double, single).dtype == np.float64
