from __future__ import annotations

import numpy as np

from app.motion.posing.posed_start import without_posed_start
from tests.bodies import motion_of, standing, waving


def test_a_first_pose_before_a_jump_is_removed() -> None:
    wave = waving(4.0)
    posed = np.concatenate([wave[:1] + np.array([0.5, 0.0, 0.0]), wave])
    np.testing.assert_allclose(
        without_posed_start(motion_of(posed)).positions, motion_of(wave).positions, atol=1e-6
    )


def test_a_motion_without_a_jump_is_not_changed() -> None:
    for positions in (waving(4.0), standing(60), standing(2)):
        motion = motion_of(positions)
        assert without_posed_start(motion) is motion
