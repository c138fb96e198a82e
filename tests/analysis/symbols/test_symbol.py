from __future__ import annotations

import numpy as np
import pytest

from app.analysis.symbols.channels import symbol_features
from app.analysis.symbols.symbol import describe_symbol, symbol_from_arrays
from app.models.words.symbol_space import symbol_distances
from app.motion.frame.body_frame import body_track
from app.numerics.hmm.model import GaussianHMM
from tests.bodies import motion_of, standing, turned_about_y, walking, waving


def described(positions: np.ndarray) -> dict[str, np.ndarray]:
    return describe_symbol(symbol_features(body_track(motion_of(positions))))


def symbol(positions: np.ndarray) -> GaussianHMM:
    return symbol_from_arrays(described(positions))


@pytest.mark.parametrize(("frames", "states"), [(2, 1), (30, 10), (300, 30)])
def test_shapes_of_the_stored_arrays(frames: int, states: int) -> None:
    arrays = described(walking(seconds=(frames - 1) / 30))
    shapes = {name: array.shape for name, array in arrays.items()}
    assert shapes == {
        "symbol_means": (states, 26),
        "symbol_variances": (states, 26),
        "symbol_transitions": (states, states),
    }
    assert {array.dtype for array in arrays.values()} == {np.dtype(np.float32)}
    assert all(np.isfinite(array).all() for array in arrays.values())


def test_the_same_motion_gives_the_same_symbol() -> None:
    one, again = described(walking()), described(walking())
    for name, array in one.items():
        np.testing.assert_array_equal(array, again[name])


def test_similar_motions_are_near() -> None:
    walk, again = symbol(walking()), symbol(turned_about_y(walking(speed=1.3), 1.0))
    others = [symbol(waving()), symbol(standing()), symbol(walking(steps_hz=1.6, speed=3.0))]
    distances = symbol_distances([walk], [again, *others])[0]
    assert distances[0] < 0.5 * distances[1:].min()
