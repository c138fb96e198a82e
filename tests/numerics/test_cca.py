from __future__ import annotations

import numpy as np
from scipy.linalg import eig

from app.numerics.cca import fit_cca


def pair(seed: int = 0, rows: int = 200) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    shared = rng.normal(size=(rows, 2))
    x = shared @ rng.normal(size=(2, 4)) + rng.normal(size=(rows, 4)) + 5.0
    y = shared @ rng.normal(size=(2, 3)) + rng.normal(size=(rows, 3)) - 2.0
    return x, y


def test_correlations_are_the_eigenvalues_of_equation_13() -> None:
    x, y = pair()
    sx, sy = np.cov(x.T), np.cov(y.T)
    sxy = np.cov(x.T, y.T)[:4, 4:]
    values = eig(sxy @ np.linalg.inv(sy) @ sxy.T, sx)[0].real
    ours = fit_cca(x, y, ridge=0.0).correlations
    np.testing.assert_allclose(ours**2, np.sort(values)[::-1][:3], atol=1e-9)


def test_projections_have_unit_variance_and_those_correlations() -> None:
    x, y = pair()
    found = fit_cca(x, y, ridge=0.0)
    f, g = (x - found.x_mean) @ found.a, (y - found.y_mean) @ found.b
    np.testing.assert_allclose(np.cov(f.T), np.eye(3), atol=1e-9)
    np.testing.assert_allclose(np.cov(f.T, g.T)[:3, 3:], np.diag(found.correlations), atol=1e-9)


def test_dependent_label_vectors_give_finite_results() -> None:
    x, y = pair()
    labels = (y > 0).astype(float)
    doubled = np.hstack([labels, labels, 1 - labels, np.zeros((len(y), 2))])
    found = fit_cca(x, doubled, ridge=1e-2)
    assert np.isfinite(found.a).all()
    assert np.isfinite(found.b).all()
    assert (found.correlations <= 1.0).all()


def test_constant_sides_project_to_zero() -> None:
    x, y = pair(rows=5)
    found = fit_cca(np.ones_like(x), y, ridge=1e-2)
    assert not found.a.any()
    assert np.isfinite(found.b).all()


def test_fewer_rows_than_columns() -> None:
    x, y = pair(rows=3)
    found = fit_cca(x, y, ridge=1e-2)
    assert found.a.shape[1] == found.b.shape[1] == len(found.correlations)
