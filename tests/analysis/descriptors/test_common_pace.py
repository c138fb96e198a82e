"""At a common pace, a motion is the same at any tempo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.analysis.descriptors.active_part import FAST_QUANTILE, joint_speed
from app.analysis.descriptors.common_pace import COMMON_PACE, MAX_CHANGE, at_common_pace
from app.motion.frame.body_frame import smooth_track
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving

NAMES = ("motion_vector", "paced_vector")


def _described(motion: Motion) -> dict[str, FloatArray]:
    return dict(describe_for_search(motion, NAMES).arrays)


def test_fast_moments_have_the_common_pace() -> None:
    track = at_common_pace(smooth_track(motion_of(walking())))
    pace = np.quantile(joint_speed(track), FAST_QUANTILE)
    assert pace == pytest.approx(COMMON_PACE, rel=0.05)


@pytest.mark.parametrize("factor", [0.5, 1 / 1.5, 1.5, 2.0])
def test_the_vector_at_a_common_pace_hardly_depends_on_the_tempo(factor: float) -> None:
    walk, wave = motion_of(walking()), motion_of(waving())
    played = replace(walk, frame_rate=walk.frame_rate * factor)
    one, other, third = (_described(motion) for motion in (walk, played, wave))
    timed, paced = (np.linalg.norm(one[name] - other[name]) for name in NAMES)
    others = np.linalg.norm(one["paced_vector"] - third["paced_vector"])
    assert paced < 0.5 * timed
    assert paced < 0.25 * others


def test_a_rest_is_changed_by_the_limit_and_has_a_finite_vector() -> None:
    rest = motion_of(standing(60))
    track = smooth_track(rest)
    assert at_common_pace(track).frames == pytest.approx(track.frames / MAX_CHANGE, abs=1)
    assert np.isfinite(_described(rest)["paced_vector"]).all()


def test_two_frames_stay_two_frames() -> None:
    assert at_common_pace(smooth_track(motion_of(standing(2)))).frames == 2
