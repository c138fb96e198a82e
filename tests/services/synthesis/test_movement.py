"""Jerk and foot skate of a motion beside those of real takes."""

from __future__ import annotations

import numpy as np
import pytest

from app.services.library.library import Library
from app.services.synthesis.movement import (
    MIN_JERK,
    MIN_SKATE,
    Movement,
    doubts,
    jerk_of,
    movement_of,
    real_movement,
)
from app.store.clips.record import ClipRecord
from tests.bodies import motion_of, walking


def test_the_jerk_of_a_swing_is_known() -> None:
    rate, hz, reach = 240.0, 1.0, 0.3
    t = np.arange(round(4 * rate)) / rate
    swing = np.zeros((len(t), 2, 3))
    swing[:, 0, 1] = reach * np.sin(2 * np.pi * hz * t)
    # one of two joints swings, and the mean square of a cosine is a half
    expected = reach * (2 * np.pi * hz) ** 3 / np.sqrt(2) / np.sqrt(2)
    assert jerk_of(swing, rate) == pytest.approx(expected, rel=0.01)
    assert jerk_of(swing[:3], rate) == 0.0


def test_the_frame_rate_hardly_matters() -> None:
    slow, fast = (movement_of(motion_of(walking(4.0, rate), rate)) for rate in (30.0, 120.0))
    assert fast.jerk == pytest.approx(slow.jerk, rel=0.1)
    assert fast.skate == pytest.approx(slow.skate, rel=0.1)


def test_twice_the_real_jerk_or_skate_is_doubted_with_both_numbers() -> None:
    real = Movement(skate=0.2, jerk=540.0)
    assert doubts(Movement(0.4, 1080.0), real, "dash") == ()
    (jerky,) = doubts(Movement(0.2, 1834.0), real, "dash")
    assert (jerky.code, jerky.value, jerky.real) == ("jerky", 1834.0, 540.0)
    assert "1834" in jerky.detail
    assert "540" in jerky.detail
    (sliding,) = doubts(Movement(0.5, 540.0), real, "dash")
    assert (sliding.code, sliding.value, sliding.real) == ("feet_slide", 0.5, 0.2)


def test_what_hardly_moves_is_not_doubted() -> None:
    still = Movement(skate=0.001, jerk=0.1)
    assert doubts(Movement(1.9 * MIN_SKATE, 1.9 * MIN_JERK), still, "stand") == ()
    assert doubts(Movement(9.0, 9e9), None, "stand") == ()


def test_real_takes_are_measured_and_removed_ones_are_left_out(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    ids = [clip.id for clip in ready_clips]
    one = real_movement(ready_library, ids[:1])
    assert one is not None
    assert one.jerk > 0
    assert real_movement(ready_library, ["clip_gone", ids[0]]) == one
    assert real_movement(ready_library, ["clip_gone"]) is None
    assert real_movement(ready_library, ids) is not None
