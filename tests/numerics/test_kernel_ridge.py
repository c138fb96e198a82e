from __future__ import annotations

import numpy as np
import pytest
import scipy

from app.numerics import kernel_ridge
from app.numerics.kernel_ridge import (
    PENALTIES,
    WIDTHS,
    fit_kernel_ridge,
    gaussian_kernel,
    leave_one_out_error,
)


@pytest.fixture
def data() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(120, 3))
    outputs = np.stack([np.sin(rows[:, 0] * 2), rows[:, 1] > 0], axis=1)
    return rows, outputs + rng.normal(size=outputs.shape) * 0.05


def test_the_closed_form_equals_leaving_each_row_out(data) -> None:  # type: ignore[no-untyped-def]
    rows, outputs = data[0][:25], data[1][:25]
    kernel = gaussian_kernel(rows, rows, 1.0)
    for penalty in PENALTIES:
        residuals = []
        for out in range(25):
            kept = np.delete(np.arange(25), out)
            inner = kernel[np.ix_(kept, kept)] + penalty * np.eye(24)
            residuals.append(
                outputs[out] - kernel[out, kept] @ np.linalg.solve(inner, outputs[kept])
            )
        error = leave_one_out_error(kernel, outputs, penalty)
        assert error == pytest.approx((np.array(residuals) ** 2).mean())


def test_the_chosen_width_and_penalty_are_the_best_of_all(data) -> None:  # type: ignore[no-untyped-def]
    rows, outputs = data
    model = fit_kernel_ridge(rows, outputs)
    unit = np.median(scipy.spatial.distance.pdist(rows))
    centered = outputs - outputs.mean(axis=0)
    errors = {
        (share * unit, penalty): leave_one_out_error(
            gaussian_kernel(rows, rows, share * unit), centered, penalty
        )
        for share in WIDTHS
        for penalty in PENALTIES
    }
    width, penalty = min(errors, key=lambda pair: errors[pair])
    assert model.width == pytest.approx(width)
    assert model.penalty == penalty


def test_held_out_rows_are_predicted(data) -> None:  # type: ignore[no-untyped-def]
    rows, outputs = data
    model = fit_kernel_ridge(rows[:90], outputs[:90])
    error = ((model.predict(rows[90:]) - outputs[90:]) ** 2).mean()
    assert error < 0.5 * outputs[90:].var(axis=0).mean()


def test_a_subset_of_centers_predicts_nearly_the_same(  # type: ignore[no-untyped-def]
    data, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows, outputs = data
    whole = fit_kernel_ridge(rows, outputs).predict(rows)
    monkeypatch.setattr(kernel_ridge, "MAX_CENTERS", 80)
    monkeypatch.setattr(kernel_ridge, "_BLOCK", 50)
    part = fit_kernel_ridge(rows, outputs)
    assert len(part.centers) == 80
    assert np.abs(part.predict(rows) - whole).mean() < 0.05


def test_far_from_all_centers_it_predicts_the_mean(data) -> None:  # type: ignore[no-untyped-def]
    rows, outputs = data
    far = fit_kernel_ridge(rows, outputs).predict(np.full((1, 3), 1e3))
    np.testing.assert_allclose(far[0], outputs.mean(axis=0))


@pytest.mark.parametrize("count", [1, 2, 4])
def test_few_or_equal_rows(count: int) -> None:
    model = fit_kernel_ridge(np.ones((count, 2)), np.eye(count))
    assert np.isfinite(model.predict(np.ones((3, 2)))).all()
    assert model.predict(np.ones((0, 2))).shape == (0, count)
