"""Frame features depend only on the movement."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.frame_features import (
    FEATURES,
    TRAVEL,
    features_at_10hz,
    frame_features,
)
from app.motion.frame.body_frame import body_track
from tests.bodies import motion_of, standing, turned_about_y, walking


def test_columns_are_positions_velocities_travel_and_yaw_rate() -> None:
    track = body_track(motion_of(walking(turn=0.5)))
    features = frame_features(track)
    assert features.shape == (track.frames, FEATURES)
    np.testing.assert_array_equal(features[:, :39], track.local.reshape(-1, 39))
    # half the change in a third of a second
    by_hand = (track.local[20] - track.local[18]).ravel() * 15 / 3 / 2
    np.testing.assert_allclose(features[19, 39:78], by_hand, atol=1e-9)
    assert features[:, 80].mean() == pytest.approx(1.2 / track.body_length, rel=0.02)
    np.testing.assert_allclose(features[:, 81], 0.5, atol=1e-3)


def test_position_heading_and_size_change_nothing() -> None:
    body = walking(turn=0.5)
    one = frame_features(body_track(motion_of(body)))
    moved = turned_about_y(body, 2.0) * 1.7 + [3.0, 0.5, -4.0]
    np.testing.assert_allclose(frame_features(body_track(motion_of(moved))), one, atol=1e-3)


def test_at_10_hz_travel_has_double_weight() -> None:
    features = frame_features(body_track(motion_of(walking(turn=0.5))))
    slow = features_at_10hz(features, 30.0)
    assert slow.shape == (41, FEATURES)
    assert slow.dtype == np.float32
    np.testing.assert_allclose(slow[20, TRAVEL], 2 * features[60, TRAVEL], rtol=0.02, atol=1e-3)


def test_a_still_body_has_zero_velocities() -> None:
    features = frame_features(body_track(motion_of(standing(2))))
    assert (features[:, 39:] == 0).all()
