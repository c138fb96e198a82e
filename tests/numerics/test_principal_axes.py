from __future__ import annotations

import numpy as np
import pytest

from app.numerics.principal_axes import principal_axes


@pytest.mark.parametrize("shape", [(30, 8), (8, 30)])
def test_axes_are_those_of_the_svd(shape: tuple[int, int]) -> None:
    samples = np.random.default_rng(0).normal(size=shape) * np.linspace(3, 1, shape[1])
    found = principal_axes(samples, 4)
    right = np.linalg.svd(samples - samples.mean(axis=0))[2][:4].T
    np.testing.assert_allclose(np.abs(found.axes.T @ right), np.eye(4), atol=1e-8)
    np.testing.assert_allclose(found.project(samples).mean(axis=0), 0, atol=1e-12)


def test_uncentered_axes_span_the_samples() -> None:
    samples = 5 + np.random.default_rng(1).normal(size=(4, 20))
    found = principal_axes(samples, 10, centered=False)
    np.testing.assert_allclose(found.project(samples) @ found.axes.T, samples, atol=1e-10)


def test_samples_that_are_all_the_same_have_one_axis_and_no_nan() -> None:
    found = principal_axes(np.ones((3, 5)), 4)
    assert found.axes.shape == (5, 1)
    assert np.isfinite(found.project(np.ones((3, 5)))).all()
