from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH
from app.models.synthesis.agreement import agreement


def shapes(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, SHAPE_LENGTH))


def test_equal_motions_agree_in_full_in_any_posture() -> None:
    one = shapes(1)
    assert agreement(np.repeat(one, 4, axis=0)) == pytest.approx(1.0)
    postures = np.tile(np.random.default_rng(2).normal(size=(4, 43)), 32)
    assert agreement(one + np.pad(postures, ((0, 0), (0, 2)))) == pytest.approx(1.0)
    assert agreement(one) == 1.0
    assert agreement(np.zeros((3, SHAPE_LENGTH))) == 1.0


@pytest.mark.parametrize("count", [2, 3, 10])
def test_unrelated_motions_do_not_agree_in_any_number(count: int) -> None:
    assert agreement(shapes(count)) == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("count", [2, 8])
def test_agreement_is_the_common_share(count: int) -> None:
    common, own = shapes(1), shapes(count, seed=1)
    assert agreement(np.sqrt(0.6) * common + np.sqrt(0.4) * own) == pytest.approx(0.6, abs=0.08)


def test_opposite_motions_agree_less_than_unrelated_ones() -> None:
    one = shapes(1)
    assert agreement(np.concatenate([one, -one])) == pytest.approx(-1.0)
