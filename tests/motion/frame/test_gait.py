"""Gait cycles are found in walks of any speed and length, and in no other movements."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.frame.body_frame import body_track
from app.motion.frame.gait import foot_split, gait_cycles
from tests.bodies import motion_of, standing, walking, waving


@pytest.mark.parametrize("steps_hz", [0.6, 0.9, 1.4])
@pytest.mark.parametrize("turn", [0.0, 0.8])
def test_a_walk_has_its_cycles(steps_hz: float, turn: float) -> None:
    track = body_track(motion_of(walking(8.0, steps_hz=steps_hz, turn=turn)))
    cycles = gait_cycles(track)
    assert len(cycles) in {int(8 * steps_hz) - 1, int(8 * steps_hz)}
    lengths = np.array([stop - first for first, stop in cycles])
    np.testing.assert_allclose(lengths, 30 / steps_hz, atol=1.01)
    split = foot_split(track)
    assert all(split[first] > 0 >= split[first - 1] for first, _ in cycles)


@pytest.mark.parametrize("body", [standing(), waving(), walking(speed=0.0)], ids=range(3))
def test_movements_on_the_spot_have_no_cycles(body: np.ndarray) -> None:
    assert gait_cycles(body_track(motion_of(body))) == []


def test_a_clip_of_one_stride_has_one_cycle() -> None:
    whole = walking(4.0, steps_hz=0.9)
    part = whole[46:97]  # a cycle lasts 33 frames; upward crossings are at 67 and 100
    cycles = gait_cycles(body_track(motion_of(part)))
    assert len(cycles) == 1
    first, stop = cycles[0]
    assert 0.84 * 33 <= stop - first <= 34
    assert 0 <= first < stop <= 51


def test_two_frames_have_no_cycles() -> None:
    assert gait_cycles(body_track(motion_of(standing(2)))) == []
