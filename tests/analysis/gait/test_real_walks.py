"""Angles and gait of real walks: what is known of walking, and two files of one motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.analysis.angles.angles import JointAngles, angles_of
from app.analysis.angles.definitions import ANGLE_NAMES
from app.analysis.angles.segment_frames import Neutral
from app.analysis.gait.gait_cycle import mean_cycles
from app.analysis.gait.strides import strides_of
from app.analysis.gait.summary import summarize
from app.analysis.gait.walk import walk_of
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.posing.file_rotations import animation_of_recording
from tests.real_clips import real_clips

WALKS = (
    ("cmu-bvh/07_05.bvh", Neutral.REST_POSE),
    ("cmu-bvh/08_03.bvh", Neutral.REST_POSE),
    ("bandai-namco-1/walk_normal_001.bvh", Neutral.UPRIGHT_POSE),
)


def angles(path: Path, skeleton: Path | None = None) -> tuple[Motion, JointAngles]:
    recording = read_recording(path.read_bytes(), skeleton.read_bytes() if skeleton else None)
    motion = canonicalize(recording)
    return motion, angles_of(motion, animation_of_recording(recording, motion))


@pytest.mark.parametrize(("name", "neutral"), WALKS)
def test_a_walk_is_as_textbooks_show_it(name: str, neutral: Neutral) -> None:
    motion, found = angles(real_clips() / name)
    assert found.neutral is neutral
    strides = strides_of(walk_of(motion))
    gait = {row.parameter.name: row.both.mean for row in summarize(strides)}
    assert 70 < gait["cadence_steps_per_min"] < 130
    assert 58 < gait["stance_pct"] < 68
    assert 15 < gait["double_support_pct"] < 35
    assert gait["stride_length_m"] == pytest.approx(2 * gait["step_length_m"], rel=0.05)
    for cycle in mean_cycles(found, strides):
        mean = dict(zip(cycle.names, cycle.mean.T, strict=True))
        knee, hip, ankle = (
            mean[f"{joint}_deg"] for joint in ("knee_flexion", "hip_flexion", "ankle_dorsiflexion")
        )
        assert 55 < knee.max() < 80
        assert 68 <= np.argmax(knee) <= 80
        assert 40 <= np.argmin(hip) <= 65
        assert np.ptp(hip) > 25
        assert 60 <= np.argmin(ankle) <= 75  # the foot pushes off
        assert np.abs(mean["knee_adduction_deg"]).max() < 5


def test_the_same_motion_in_two_formats_has_the_same_angles() -> None:
    folder = real_clips()
    _, amc = angles(folder / "cmu-asfamc/02_01.amc", folder / "cmu-asfamc/02.asf")
    _, bvh = angles(folder / "cmu-bvh/02_01.bvh")
    # the BVH file begins with a T-pose
    frames = min(len(amc.degrees), len(bvh.degrees) - 1)
    apart = amc.degrees[:frames] - bvh.degrees[1 : frames + 1]
    # angles beyond half a turn, as the plane in which a hanging arm is raised
    apart = (apart + 180) % 360 - 180
    for name, column in zip(ANGLE_NAMES, apart.T, strict=True):
        assert np.abs(column).max() < 0.1, name
