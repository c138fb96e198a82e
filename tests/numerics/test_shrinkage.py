from __future__ import annotations

import numpy as np
import pytest

from app.numerics.shrinkage import oracle_share


def mixed(covariance: np.ndarray, share: float) -> np.ndarray:
    size = len(covariance)
    return (1 - share) * covariance + share * np.trace(covariance) / size * np.eye(size)


@pytest.mark.parametrize("samples", [8, 30, 200])
@pytest.mark.parametrize("least", [1.0, 0.3, 0.02])
def test_few_other_shares_have_a_smaller_error(samples: int, least: float) -> None:
    """The slow twin knows the truth and tries all shares."""
    rng = np.random.default_rng(samples)
    deviations = np.geomspace(1, least, 12)
    truth = np.diag(deviations**2)
    tried = np.linspace(0, 1, 101)
    errors, ours = np.zeros(len(tried)), 0.0
    for _ in range(60):
        rows = rng.standard_normal((samples, 12)) * deviations
        found = rows.T @ rows / samples
        errors += [((mixed(found, share) - truth) ** 2).sum() for share in tried]
        ours += ((mixed(found, oracle_share(found, samples)) - truth) ** 2).sum()
    assert ours <= 1.15 * errors.min() + 0.02 * errors[0]


def test_spheres_stay_spheres_and_clear_shapes_are_kept() -> None:
    assert oracle_share(np.eye(5), 10) == 1.0
    assert oracle_share(np.zeros((3, 3)), 10) == 1.0
    assert oracle_share(np.diag([1.0, 0, 0, 0]), 1000) < 0.01
