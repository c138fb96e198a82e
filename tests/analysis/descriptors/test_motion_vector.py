"""The motion vector never changes, is invariant, and separates motions."""

from __future__ import annotations

import hashlib
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import logm

from app.analysis.descriptors.frame_features import frame_features
from app.analysis.descriptors.motion_vector import (
    COVARIANCE_SCALE,
    RIDGE,
    describe,
    log_covariance,
    motion_vector,
    narrow,
    projection,
    wide,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking, waving

WIDE_PROJECTION_SHA256 = "4af14d8170e8bb4a80c22498f868799ea69b15e4b25050b8149fe2c2e7170ecd"
PROJECTION_SHA256 = "b0d178b49a7db1d9a942665857243e94f9d94aeb57ac6d00ac212d001a61b291"


def vector_of(body: FloatArray, rate: float = 30.0) -> FloatArray:
    return motion_vector(frame_features(body_track(motion_of(body, rate))))


def apart(one: FloatArray, other: FloatArray) -> float:
    """Distance in units of the vectors' own length."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(one))


def test_the_projection_never_changes() -> None:
    rounded = np.round(projection() * 1e6).astype("<i8")
    assert hashlib.sha256(rounded.tobytes()).hexdigest() == PROJECTION_SHA256
    rounded = np.round(projection(512) * 1e6).astype("<i8")
    assert hashlib.sha256(rounded.tobytes()).hexdigest() == WIDE_PROJECTION_SHA256


def test_the_wide_vector_keeps_distances_better() -> None:
    features = [
        frame_features(body_track(motion_of(body)))
        for body in (walking(turn=0.3), walking(), waving(), standing())
    ]
    described = [describe(one) for one in features]
    errors = {
        project: max(
            abs(np.linalg.norm(project(one) - project(other)) / np.linalg.norm(one - other) - 1)
            for one, other in combinations(described, 2)
        )
        for project in (narrow, wide)
    }
    assert errors[wide] < 0.1
    np.testing.assert_array_equal(narrow(described[0]), motion_vector(features[0]))
    assert wide(described[0]).shape == (512,)


def test_the_covariance_s_logarithm_equals_its_slow_twin() -> None:
    features = frame_features(body_track(motion_of(walking(turn=0.3))))
    slow = np.real(logm(np.cov(features.T, bias=True) + RIDGE * np.eye(82)))
    rows, columns = np.triu_indices(82)
    expected = slow[rows, columns] * np.where(rows == columns, 1, np.sqrt(2)) * COVARIANCE_SCALE
    np.testing.assert_allclose(log_covariance(features), expected, atol=1e-8)


@given(turn=st.floats(-4, 4), x=st.floats(-9, 9), z=st.floats(-9, 9), scale=st.floats(0.3, 3))
@settings(max_examples=25, deadline=None)
def test_position_heading_and_size_change_nothing(
    turn: float, x: float, z: float, scale: float
) -> None:
    body = walking(turn=0.5)
    moved = turned_about_y(body, turn) * scale + [x, 0.0, z]
    assert apart(vector_of(body), vector_of(moved)) < 1e-3


@pytest.mark.parametrize("rate", [50.0, 60.0, 90.0, 100.0, 120.0])
def test_frame_rate_changes_it_by_less_than_a_hundredth(rate: float) -> None:
    one, other = walking(6.0, turn=0.3), walking(6.0, rate, turn=0.3)
    assert apart(vector_of(one), vector_of(other, rate)) < 0.01


def test_like_motions_are_nearer_than_unlike_ones() -> None:
    slow, fast, wave = walking(steps_hz=0.8), walking(steps_hz=1.0), waving()
    assert apart(vector_of(slow), vector_of(fast)) < apart(vector_of(slow), vector_of(wave)) / 2


def test_little_and_still_motion_has_a_vector() -> None:
    for body in (standing(2), standing(90), walking(0.07)):
        vector = vector_of(body)
        assert vector.shape == (128,)
        assert vector.dtype == np.float32
        assert np.isfinite(vector).all()
