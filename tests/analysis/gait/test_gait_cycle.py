"""Angles over the gait cycle."""

from __future__ import annotations

import numpy as np

from app.analysis.angles.angles import JointAngles
from app.analysis.angles.definitions import ANGLE_NAMES
from app.analysis.angles.segment_frames import Neutral
from app.analysis.gait.gait_cycle import POINTS, mean_cycles
from app.analysis.gait.strides import Stride

RATE = 100.0


def stride(side: str, strike: float, time: float, heading: float = 0.0) -> Stride:
    return Stride(
        side=side, strike=strike, off=strike + 0.6 * time, next_strike=strike + time,
        other_strike=strike + 0.5 * time, other_off=strike + 0.1 * time, length=1.2,
        step_length=0.6, step_width=0.1, heading=heading, is_run=False,
    )  # fmt: skip


def angles() -> JointAngles:
    """Each angle is the time in hundredths of seconds, plus its number."""
    frames = np.arange(400.0)
    return JointAngles(frames[:, None] + np.arange(len(ANGLE_NAMES)), Neutral.REST_POSE, RATE)


def test_a_cycle_goes_from_strike_to_strike() -> None:
    (left,) = mean_cycles(angles(), [stride("left", 0.5, 1.0), stride("left", 1.5, 1.2)])
    assert (left.side, left.strides) == ("left", 2)
    assert left.mean.shape == left.sd.shape == (POINTS, len(left.names))
    knee = left.names.index("knee_flexion_deg")
    number = ANGLE_NAMES.index("left_knee_flexion_deg")
    # the first cycle reads 50 to 150, the second one 150 to 270
    np.testing.assert_allclose(left.mean[[0, 50, 100], knee], np.array([100, 155, 210]) + number)
    np.testing.assert_allclose(left.sd[0, knee], np.sqrt(5000))


def test_a_side_has_its_own_angles_and_those_of_the_middle() -> None:
    left, right = mean_cycles(angles(), [stride("right", 0.5, 1.0), stride("left", 1.0, 1.0)])
    assert (left.side, right.side) == ("left", "right")
    assert left.names == right.names
    assert not any(name.startswith(("left_", "right_")) for name in left.names)
    assert np.isnan(left.sd).all()


def test_rotations_are_relative_to_the_direction_of_the_stride() -> None:
    still = JointAngles(np.full((400, len(ANGLE_NAMES)), 370.0), Neutral.REST_POSE, RATE)
    (cycle,) = mean_cycles(still, [stride("left", 0.5, 1.0, np.radians(4.0))])
    np.testing.assert_allclose(cycle.mean[:, cycle.names.index("pelvis_rotation_deg")], 6.0)
    np.testing.assert_allclose(cycle.mean[:, cycle.names.index("knee_flexion_deg")], 370.0)
