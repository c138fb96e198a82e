from __future__ import annotations

import numpy as np
import pytest

from app.motion.frame.body_frame import body_track
from app.motion.frame.posed_start import posed_frames, with_held_start, without_posed_start
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, waving


def thrown(frames: int = 1) -> FloatArray:
    """A wave after `frames` of another pose."""
    wave = waving(4.0)
    return np.concatenate([np.repeat(wave[:1] + np.array([0.5, 0.0, 0.0]), frames, axis=0), wave])


@pytest.mark.parametrize("frames", [1, 2, 20])
def test_a_pose_before_a_jump_is_found(frames: int) -> None:
    motion = motion_of(thrown(frames))
    assert posed_frames(motion) == frames
    np.testing.assert_allclose(
        without_posed_start(motion).positions, motion_of(waving(4.0)).positions, atol=1e-6
    )


@pytest.mark.parametrize("frames", [1, 20])
def test_held_starts_keep_all_times(frames: int) -> None:
    motion = motion_of(thrown(frames))
    held = with_held_start(motion)
    assert held.frames == motion.frames
    np.testing.assert_array_equal(held.positions[frames:], motion.positions[frames:])
    np.testing.assert_array_equal(held.positions[:frames], held.positions[[frames] * frames])
    np.testing.assert_array_equal(motion.positions[0], motion_of(thrown(frames)).positions[0])


def test_no_analysis_reads_the_pose() -> None:
    track, without = (body_track(motion_of(each)) for each in (thrown(), waving(4.0)))
    assert (
        np.abs(np.diff(track.local, axis=0)).max()
        < 1.2 * np.abs(np.diff(without.local, axis=0)).max()
    )


@pytest.mark.parametrize(
    "positions",
    [
        waving(4.0),
        standing(60),
        standing(2),
        np.concatenate([waving(3.0), waving(3.0) + 1.0]),  # a cut, but both parts move
        thrown(90),  # 3 s of a pose are a part of the motion
    ],
    ids=["no jump", "still", "two frames", "a cut between movements", "a long pose"],
)
def test_other_motions_are_not_changed(positions: FloatArray) -> None:
    motion = motion_of(positions)
    assert without_posed_start(motion) is motion
    assert with_held_start(motion) is motion
