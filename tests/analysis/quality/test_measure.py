"""The measures of bodies whose faults, loops and ranges are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.movement_signs import movement_signs
from app.analysis.quality.definitions import DEFINITIONS, NAMES
from app.analysis.quality.flow import LOOP_VELOCITY, MIN_LOOP, best_loop
from app.analysis.quality.measure import Quality, measure_quality
from app.motion.frame.body_frame import body_track, smooth_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import R, motion_of, move_joint, standing, turned_about_y, walking, waving

FEET = [SUN_ROLES.index(R.LEFT_FOOT), SUN_ROLES.index(R.RIGHT_FOOT)]


def measured(body: FloatArray, rate: float = 30.0) -> Quality:
    motion = motion_of(body, rate)
    smooth = smooth_track(motion)
    return measure_quality(body_track(motion), smooth, movement_signs(active_part(smooth)))


def value(body: FloatArray, name: str) -> float:
    found = measured(body)[name]
    assert found is not None
    return found


def test_every_measure_is_defined_and_found() -> None:
    assert len(set(NAMES)) == len(NAMES)
    assert all(one.text and one.unit for one in DEFINITIONS)
    assert tuple(measured(walking())) == NAMES
    assert all(one is not None for one in measured(walking()).values())


def test_a_standing_body_has_no_faults() -> None:
    found = measured(standing(120))
    for name in ("foot_skate", "ground_penetration", "floating", "joint_limits", "self_contact"):
        assert found[name] == pytest.approx(0, abs=1e-6)
    for name in ("airborne_time", "unsupported_time", "turn", "dominance", "start_speed"):
        assert found[name] == pytest.approx(0, abs=1e-3)


def test_feet_that_slide_have_the_speed_of_the_body() -> None:
    body = standing(120)
    body[:, :, 0] += np.linspace(0, 2.0, 120)[:, None]
    assert value(body, "foot_skate") == pytest.approx(2.0 / 119 * 30, rel=0.05)


def test_a_sunk_foot_penetrates_and_a_raised_body_floats() -> None:
    sunk, raised = standing(150), standing(150)
    sunk[110:, FEET, 1] -= 0.1
    raised[110:, :, 1] += 0.1
    assert value(sunk, "ground_penetration") == pytest.approx(0.08 * 40 / 150, rel=0.2)
    assert value(sunk, "floating") < 0.005
    assert value(raised, "floating") == pytest.approx(0.08 * 40 / 150, rel=0.2)
    assert value(raised, "ground_penetration") == pytest.approx(0, abs=1e-3)


def test_a_jump_is_in_the_air_as_long_as_it_falls() -> None:
    body, rate, flight = standing(180), 30.0, 0.6
    t = np.arange(180) / rate - 3.0
    body[:, :, 1] += np.maximum(9.81 / 2 * (flight**2 / 4 - t**2), 0.0)[:, None]
    found = measured(body)
    assert found["airborne_time"] == pytest.approx(flight, abs=0.25)
    assert found["floating"] == pytest.approx(0, abs=0.005)


def test_noise_is_jitter() -> None:
    rng = np.random.default_rng(0)
    body = walking(6.0)
    noisy = body + rng.normal(scale=0.005, size=body.shape)
    assert value(noisy, "jitter") > value(body, "jitter") + 1


def test_joints_beyond_their_limits_are_counted() -> None:
    body = standing(100)
    move_joint(body, R.LEFT_KNEE, np.outer(np.arange(100) >= 50, [0.0, 0.0, -0.25]))
    assert value(body, "joint_limits") == pytest.approx(0.5, abs=0.05)


def test_limbs_that_merge_touch() -> None:
    body = standing(100)
    trunk = body[:, SUN_ROLES.index(R.HIPS)] * 0.5 + body[:, SUN_ROLES.index(R.NECK)] * 0.5
    inside = trunk - body[:, SUN_ROLES.index(R.RIGHT_HAND)]
    move_joint(body, R.RIGHT_HAND, inside * (np.arange(100) >= 50)[:, None])
    assert value(body, "self_contact") == pytest.approx(0.5, abs=0.1)


def test_the_side_that_moves_more_leads() -> None:
    assert value(waving(), "dominance") < -0.9  # the right hand
    body = waving()
    flipped = body * np.array([-1.0, 1.0, 1.0])
    order = [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]
    assert value(flipped[:, order], "dominance") == pytest.approx(-value(body, "dominance"))


def test_turns_add_up_to_both_sides() -> None:
    to_left = walking(4.0, turn=0.5)
    assert value(to_left, "net_turn") == pytest.approx(np.degrees(2.0), rel=0.1)
    there_and_back = turned_about_y(standing(181), np.pi * np.sin(np.linspace(0, np.pi, 181)) ** 2)
    assert value(there_and_back, "turn") == pytest.approx(360, rel=0.1)
    assert value(there_and_back, "net_turn") == pytest.approx(0, abs=1)


def test_a_walk_loops_after_whole_cycles() -> None:
    found = measured(walking(8.0, steps_hz=1.0))
    length = (found["loop_end"] or 0) - (found["loop_start"] or 0)
    assert length % 1.0 == pytest.approx(0, abs=0.05) or length % 1.0 > 0.95
    assert found["loop_gap"] == pytest.approx(0, abs=0.02)
    assert (found["cyclicity"] or 0) > 0.9


def test_the_best_loop_is_that_of_a_plain_search() -> None:
    rng = np.random.default_rng(1)
    body = standing(80) + np.cumsum(rng.normal(scale=0.01, size=(80, 13, 3)), axis=0)
    track = smooth_track(motion_of(body))
    found = best_loop(track)
    moves = np.gradient(track.local, axis=0) * track.rate * LOOP_VELOCITY
    least = np.inf, 0, 0
    apart = int(np.ceil(max(MIN_LOOP, 0.25 * track.duration) * track.rate))
    for start in range(80):
        for end in range(start + apart, 80):
            cost = np.square(track.local[start] - track.local[end]).sum()
            cost += np.square(moves[start] - moves[end]).sum()
            least = min(least, (float(np.sqrt(cost / 13)), start, end))
    assert found is not None
    assert found.gap == pytest.approx(least[0], rel=1e-6)
    assert (found.start * 30, found.end * 30) == pytest.approx(least[1:])


def test_a_range_is_the_angle_of_the_joint() -> None:
    body = standing(200)
    elbow = SUN_ROLES.index(R.RIGHT_ELBOW)
    shoulder = SUN_ROLES.index(R.RIGHT_SHOULDER)
    hand = SUN_ROLES.index(R.RIGHT_HAND)
    upper = body[0, elbow] - body[0, shoulder]
    along = upper / np.linalg.norm(upper)
    forward = np.array([0.0, 0.0, 1.0]) - along[2] * along
    forward /= np.linalg.norm(forward)
    bend = np.linspace(0, np.radians(100), 200)[:, None]
    body[:, hand] = body[:, elbow] + 0.25 * (np.cos(bend) * along + np.sin(bend) * forward)
    assert value(body, "range_right_elbow") == pytest.approx(90, abs=3)
    assert value(body, "range_left_elbow") == pytest.approx(0, abs=0.5)


def test_place_heading_and_rate_hardly_matter() -> None:
    one = measured(walking(5.0))
    moved = measured(turned_about_y(walking(5.0), 2.0) + np.array([5.0, 1.0, -3.0]))
    finer = measured(walking(5.0, rate=120.0), 120.0)
    for name in NAMES:
        if name in ("loop_start", "loop_end", "cycle_time"):
            continue
        assert moved[name] == pytest.approx(one[name], rel=1e-2, abs=1e-3), name
        assert finer[name] == pytest.approx(one[name], rel=0.1, abs=0.1), name


@pytest.mark.parametrize("frames", [2, 3, 5, 12])
def test_short_motions_have_what_can_be_measured(frames: int) -> None:
    found = measured(walking(5.0)[:frames])
    assert tuple(found) == NAMES
    assert all(one is None or np.isfinite(one) for one in found.values())


def test_a_joint_without_bones_has_no_range() -> None:
    body = standing(60)
    body[:, SUN_ROLES.index(JointRole.LEFT_HAND)] = body[:, SUN_ROLES.index(R.LEFT_ELBOW)]
    assert measured(body)["range_left_elbow"] is None
