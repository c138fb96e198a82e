from __future__ import annotations

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.analysis.descriptors.active_part import MARGIN, active_part, active_span, joint_speed
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving

WHOLE = ("motion_vector", "wide_motion_vector", "motion_sample", "angle_sample")


def waiting(positions: FloatArray, before: float, after: float) -> FloatArray:
    """The motion after and before seconds of rest, with the sway of a person who stands."""
    rng = np.random.default_rng(1)
    parts = [np.repeat(positions[:1], round(before * 30), axis=0), positions,
             np.repeat(positions[-1:], round(after * 30), axis=0)]  # fmt: skip
    sway = np.cumsum(rng.normal(0, 2e-4, (sum(map(len, parts)), 1, 3)), axis=0)
    return np.concatenate(parts) + sway


@pytest.mark.parametrize(("before", "after"), [(2.0, 0.0), (0.0, 3.0), (2.0, 1.0)])
def test_waiting_is_left_out(before: float, after: float) -> None:
    track = body_track(motion_of(waiting(walking(4.0), before, after)))
    first, stop = active_span(track)
    assert first == pytest.approx(before * 30, abs=(MARGIN + 0.2) * 30)
    assert stop == pytest.approx((before + 4.0) * 30, abs=(MARGIN + 0.2) * 30)
    assert active_part(track).frames == stop - first


@pytest.mark.parametrize("body", [walking(4.0), waving(4.0)])
def test_descriptors_hardly_depend_on_waiting(body: FloatArray) -> None:
    plain = describe_for_search(motion_of(body), WHOLE).arrays
    waited = describe_for_search(motion_of(waiting(body, 2.0, 1.0)), WHOLE).arrays
    other = describe_for_search(motion_of(waiting(walking(4.0, turn=0.5), 2.0, 1.0)), WHOLE).arrays
    for name in WHOLE:
        near, far = (np.linalg.norm(each[name] - plain[name]) for each in (waited, other))
        assert near < 0.5 * far, name


def test_a_rest_between_movements_stays() -> None:
    between = np.concatenate([waving(2.0), np.repeat(waving(2.0)[-1:], 90, axis=0), waving(2.0)])
    first, stop = active_span(body_track(motion_of(between)))
    assert (first, stop) == (0, len(between))


@pytest.mark.parametrize("body", [standing(90), standing(2)])
def test_a_motion_that_is_all_rest_is_all_active(body: FloatArray) -> None:
    assert active_span(body_track(motion_of(body))) == (0, len(body))


def test_the_speed_is_that_of_the_joints() -> None:
    moved = standing(60) + np.arange(60)[:, None, None] / 30 * np.array([0.5, 0.0, 0.0])
    track = body_track(motion_of(moved))
    np.testing.assert_allclose(joint_speed(track), 0.5 / track.body_length, rtol=1e-3)
