from __future__ import annotations

import numpy as np

from app.analysis.descriptors.angle_sample import angle_sample
from app.analysis.descriptors.motion_sample import SAMPLES, motion_sample
from app.motion.frame.body_frame import smooth_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, walking, waving


def _sample(positions: FloatArray, rate: float = 30.0) -> FloatArray:
    motion = motion_of(positions, rate)
    return angle_sample(smooth_track(motion))


def _angles(sample: FloatArray) -> FloatArray:
    return sample[:-2].reshape(SAMPLES, -1)


def test_width_and_the_tail_of_the_motion_sample() -> None:
    motion = motion_of(walking(turn=0.4))
    track = smooth_track(motion)
    sample = angle_sample(track)
    assert sample.shape == (32 * 20 + 2,)
    assert sample.dtype == np.float32
    np.testing.assert_array_equal(sample[-2:], motion_sample(track)[-2:])


def test_a_walk_is_the_same_at_another_rate_and_from_another_phase() -> None:
    once = _angles(_sample(walking(seconds=6.0, rate=30.0)))
    fast = _angles(_sample(walking(seconds=6.0, rate=120.0), 120.0))
    later = _angles(_sample(walking(seconds=6.0, rate=120.0)[70:], 120.0))
    assert np.abs(fast - once).max() < 0.02
    assert np.abs(later - fast).max() < 0.02


def test_shaking_above_six_hertz_is_not_seen() -> None:
    body = waving(seconds=4.0, rate=120.0)
    shaking = np.sin(2 * np.pi * 25.0 * np.arange(len(body)) / 120.0)[:, None, None]
    shaken = body + 0.01 * shaking * np.random.default_rng(0).normal(size=(13, 3))
    ours, theirs = _angles(_sample(body, 120.0)), _angles(_sample(shaken, 120.0))
    assert np.abs(theirs - ours).max() < 0.02
