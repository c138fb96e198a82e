"""Window vectors agree with a simple loop over windows, and are invariant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.descriptors.frame_features import TRAVEL, features_at_10hz, frame_features
from app.analysis.descriptors.windows import (
    RIDGE,
    VARIANCE_SCALE,
    WIDTH,
    WINDOW_SCALES,
    RunningSums,
    WindowScale,
    window_arrays,
    window_frames,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking, waving


def features_of(body: FloatArray, rate: float = 30.0) -> FloatArray:
    track = body_track(motion_of(body, rate))
    return features_at_10hz(frame_features(track), track.rate)


def naive_vector(cut: FloatArray) -> FloatArray:
    cut = cut.astype(np.float64)
    means = np.concatenate([cut.mean(axis=0)[:39], cut.mean(axis=0)[TRAVEL]])
    return np.concatenate([means, np.log(cut.var(axis=0) + RIDGE) * VARIANCE_SCALE])


@pytest.mark.parametrize("scale", WINDOW_SCALES, ids=lambda scale: scale.name)
def test_each_vector_is_that_of_the_frames_of_its_span(scale: WindowScale) -> None:
    features = features_of(walking(9.0, turn=0.5))
    arrays = window_arrays(features)
    spans = np.round(arrays[scale.spans] * 10).astype(int)
    expected = [naive_vector(features[first:stop]) for first, stop in spans]
    np.testing.assert_allclose(arrays[scale.vectors], expected, atol=2e-3)
    assert arrays[scale.vectors].shape == (len(spans), WIDTH)
    assert (arrays[scale.vectors].dtype, arrays[scale.spans].dtype) == (np.float16, np.float32)


@given(count=st.integers(1, 300), scale=st.sampled_from(WINDOW_SCALES))
def test_windows_are_of_one_length_and_leave_no_frame_out(count: int, scale: WindowScale) -> None:
    frames = window_frames(count, scale)
    assert frames[0, 0] == 0
    assert frames[-1, 1] == count
    assert set(frames[:, 1] - frames[:, 0]) == {min(count, scale.frames)}
    steps = np.diff(frames[:, 0])
    assert ((steps > 0) & (steps <= scale.hop)).all()


def test_an_hour_has_its_digits_to_the_end() -> None:
    features = features_of(waving(40.0))
    hour = np.tile(features, (3600 * 10 // len(features) + 1, 1))
    late = np.array([[len(hour) - len(features), len(hour) - len(features) + 20]])
    found = RunningSums(hour).vectors(late)
    np.testing.assert_allclose(found[0], naive_vector(features[:20]), atol=2e-3)


@given(turn=st.floats(-4, 4), x=st.floats(-9, 9), z=st.floats(-9, 9), scale=st.floats(0.3, 3))
@settings(max_examples=15, deadline=None)
def test_position_heading_and_size_change_nothing(
    turn: float, x: float, z: float, scale: float
) -> None:
    body = walking(turn=0.5)
    moved = turned_about_y(body, turn) * scale + [x, 0.0, z]
    one, other = (window_arrays(features_of(b)) for b in (body, moved))
    for name in one:
        np.testing.assert_allclose(one[name], other[name], atol=5e-3)


def test_a_window_is_nearer_to_its_like_than_to_another_motion() -> None:
    walk, faster, wave = (
        window_arrays(features_of(body))["window_vectors_2s"].astype(float)
        for body in (walking(steps_hz=0.9), walking(steps_hz=1.0), waving())
    )
    assert np.linalg.norm(walk[0] - faster[0]) < np.linalg.norm(walk[0] - wave[0]) / 2


def test_what_is_short_or_still_has_one_finite_window_of_each_scale() -> None:
    for body in (standing(2), standing(20), walking(0.1)):
        arrays = window_arrays(features_of(body))
        assert {len(array) for array in arrays.values()} == {1}
        assert all(np.isfinite(array).all() for array in arrays.values())
