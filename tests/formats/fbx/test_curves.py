"""Values between the keys of an FBX curve agree with the definition of a Bezier curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported
from app.formats.fbx.curves import sample
from app.formats.fbx.records import FbxFile
from app.formats.fbx.scene import FbxScene
from app.numerics.arrays import FloatArray
from tests.formats.fbx.files import (
    AUTO,
    CLAMP,
    CUBIC,
    KTIME,
    LINEAR,
    PROGRESSIVE,
    TCB,
    TIMED,
    USER,
    WEIGHTED_LEFT,
    WEIGHTED_RIGHT,
    Bone,
    Curve,
    Take,
    fbx,
    packed_weights,
)


def sampled(curve: Curve, seconds: FloatArray) -> FloatArray:
    content = fbx([Bone("Hips")], [Take("t", [{(0, "Lcl Rotation"): {"X": curve}}])])
    (found,) = FbxScene(FbxFile(content)).of_kind("AnimationCurve")
    values = sample(found, seconds * KTIME)
    assert values is not None
    return values


def bezier(x: FloatArray, y: FloatArray, at: float) -> float:
    """De Casteljau, by halving until x is near; x and y are the four points."""
    low, high = 0.0, 1.0
    for _ in range(45):
        middle = (low + high) / 2
        points = np.stack([x, y])
        while points.shape[1] > 1:
            points = points[:, :-1] * (1 - middle) + points[:, 1:] * middle
        low, high = (middle, high) if points[0, 0] < at else (low, middle)
    return float(points[1, 0])


def gap(
    start: tuple[float, float], end: tuple[float, float], slopes: tuple[float, float],
    weights: tuple[float, float], at: float,
) -> float:  # fmt: skip
    """The value between two keys (seconds, value) with these slopes and weights."""
    length = end[0] - start[0]
    right, left = weights[0] * length, weights[1] * length
    x = np.array([start[0], start[0] + right, end[0] - left, end[0]])
    y = np.array([start[1], start[1] + right * slopes[0], end[1] - left * slopes[1], end[1]])
    return bezier(x, y, at)


SLOPE = st.floats(-100, 100, width=32)
WEIGHT = st.integers(100, 9999).map(lambda n: n / 10_000)


@settings(max_examples=40, deadline=None)
@given(slopes=st.tuples(SLOPE, SLOPE), weights=st.tuples(WEIGHT, WEIGHT), end=st.floats(-50, 50))
def test_tangents_with_slopes_and_weights(
    slopes: tuple[float, float], weights: tuple[float, float], end: float
) -> None:
    end = float(np.float32(end))
    flags = CUBIC | USER | WEIGHTED_RIGHT | WEIGHTED_LEFT
    data = [(*slopes, packed_weights(*weights), 0)]
    at = np.linspace(0.05, 1.95, 9)
    found = sampled(Curve([0, 2], [3, end], flags, data), at)
    truth = [gap((0, 3), (2, end), slopes, weights, t) for t in at]
    assert np.allclose(found, truth, atol=1e-4)


def test_tangents_without_weight_have_a_third_of_the_gap() -> None:
    at = np.linspace(0, 1, 11)
    data = [(5.0, -3.0, packed_weights(0.9, 0.1), 0)]
    found = sampled(Curve([0, 1], [0, 1], CUBIC | USER, data), at)
    truth = [gap((0, 0), (1, 1), (5, -3), (1 / 3, 1 / 3), t) for t in at]
    assert np.allclose(found, truth, atol=1e-5)


@pytest.mark.parametrize(
    ("flags", "stored", "slopes"),
    [
        (CUBIC | AUTO, (0, 0), [(0, 2), (3.5, 3.5), (1.5, 1.5), (-2, 0)]),
        (CUBIC, (0, 0), [(0, 2), (3.5, 3.5), (1.5, 1.5), (-2, 0)]),
        (CUBIC | AUTO, (9, 5), [(0, 2), (3.425, 3.635), (1.675, 1.185), (-2, 0)]),
        (CUBIC | AUTO, (-40, -40), [(0, 2), (4.1, 2.9), (0.1, 2.9), (-2, 0)]),
        (CUBIC | AUTO, (200, 0), [(0, 2), (3.5, 6.5), (1.5, -5.5), (-2, 0)]),
        (CUBIC | AUTO | TIMED, (9, 5), [(0, 2), (4, 4), (8 / 3, 8 / 3), (-2, 0)]),
        (CUBIC | AUTO | PROGRESSIVE, (0, 0), [(0, 0), (3.5, 3.5), (0, 0), (0, 0)]),
    ],
)
def test_automatic_tangents(
    flags: int, stored: tuple[float, float], slopes: list[tuple[float, float]]
) -> None:
    """The keys have gaps with the slopes 2, 5 and -2 per second; slopes are left and right."""
    keys = [(0.0, 0.0), (1.0, 2.0), (3.0, 12.0), (4.0, 10.0)]
    times, values = zip(*keys, strict=True)
    curve = Curve(times, values, flags, [(*stored, 0, 0)])
    for left, at in ((0, 0.4), (1, 1.3), (1, 2.5), (2, 3.6)):
        ends = slopes[left][1], slopes[left + 1][0]
        truth = gap(keys[left], keys[left + 1], ends, (1 / 3, 1 / 3), at)
        assert sampled(curve, np.array([at]))[0] == pytest.approx(truth, abs=1e-5)


def test_clamped_automatic_tangents_are_flat_next_to_an_equal_value() -> None:
    flags = CUBIC | AUTO | CLAMP
    found = sampled(Curve([0, 1, 2, 3], [0, 5, 5, 9], flags), np.linspace(1, 2, 5))
    assert np.allclose(found, 5, atol=1e-6)


def test_progressive_tangents_do_not_overshoot() -> None:
    values = [0, 10, 10.5, 0, 8]
    found = sampled(Curve(range(5), values, CUBIC | AUTO | PROGRESSIVE), np.linspace(0, 4, 200))
    assert found.max() <= 10.5 + 1e-6
    assert found.min() >= -1e-6


def test_a_curve_is_constant_outside_its_keys() -> None:
    found = sampled(Curve([1, 2], [5, 7]), np.array([0, 1, 1.5, 2, 3]))
    assert np.allclose(found, [5, 5, 6, 7, 7])


def test_the_last_of_several_keys_at_one_time_is_used() -> None:
    found = sampled(Curve([0, 1, 1, 2], [0, 4, 9, 9]), np.array([0.5, 1, 1.5]))
    assert np.allclose(found, [2, 9, 9])


def test_tcb_keys_are_refused_only_between_keys() -> None:
    curve = Curve([0, 1, 2], [0, 1, 4], CUBIC | TCB)
    assert np.allclose(sampled(curve, np.arange(3.0)), [0, 1, 4])
    with pytest.raises(FormatNotSupported, match="TCB"):
        sampled(curve, np.array([0.5]))


def test_keys_with_an_unknown_interpolation_are_refused() -> None:
    with pytest.raises(FormatNotSupported, match="AnimationCurve"):
        sampled(Curve([0, 1], [0, 1], 0), np.array([0.5]))


def test_each_key_has_its_own_attributes() -> None:
    found = sampled(Curve([0, 1, 2], [0, 8, 10], [0x2, LINEAR, LINEAR]), np.array([0.5, 1.5]))
    assert np.allclose(found, [0, 9])
