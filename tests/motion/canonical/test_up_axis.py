"""The axis along which the body stands is up, by evidence, and never against what a file says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import BadField
from app.motion.canonical.canonical import canonicalize
from app.motion.canonical.up_axis import UP_AXES, judge_up_axis, to_y_up
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.motion.plausibility.creatures import PEOPLE, without_rest
from tests.people import CONVENTIONS, ROLES, person

R = JointRole
EXPECTED = {role: index for index, role in enumerate(ROLES)}
PERSON = person(CONVENTIONS["MotionBuilder"])
STANDING = PERSON.positions
# Rotations from Y to each axis. None is a mirror.
FROM_Y = {
    "y": np.eye(3),
    "z": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    "-y": np.diag([1, -1, -1]),
    "-z": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-x": np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
}


def turned(axis: str, positions: FloatArray = STANDING) -> FloatArray:
    return np.asarray(positions @ FROM_Y[axis].T)


def walking(steps: int = 6, rate: float = 30.0) -> Recording:
    """The person walks: each foot stands for half a step, and the hips travel level."""
    frames = int(steps * 0.5 * rate)
    t = np.arange(frames) / rate
    positions = np.repeat(PERSON.positions[:1], frames, axis=0).copy()
    positions[..., 2] += (1.2 * t)[:, None]
    for side, phase in (("left", 0.0), ("right", 0.5)):
        # In its stance a foot stands still; in its swing it moves with twice the speed.
        cycle = (t + phase) % 1.0
        ahead = np.where(cycle < 0.5, 0.3 - 1.2 * cycle, -0.3 + 1.2 * (cycle - 0.5))
        lift = np.where(cycle < 0.5, 0.0, 0.1 * np.sin(np.pi * (cycle - 0.5) / 0.5))
        for part, share in (("knee", 0.5), ("foot", 1.0), ("toes", 1.0)):
            joint = ROLES.index(R(f"{side}_{part}"))
            positions[:, joint, 2] += share * ahead
            positions[:, joint, 1] += share * lift
    return replace(PERSON, positions=positions.astype(np.float32))


def lying(height: float = 0.15) -> Recording:
    """The person lies on the back, with movements of arms and legs; the floor is at 0."""
    positions = turned("z")
    positions[..., 1] += height - positions[..., 1].min()
    return replace(PERSON, positions=positions.astype(np.float32))


def height_of_head(motion: Motion) -> float:
    head, foot = motion.roles[R.HEAD], motion.roles[R.LEFT_FOOT]
    return float(np.mean(motion.positions[:, head, 1] - motion.positions[:, foot, 1]))


def codes(motion: Motion) -> list[str]:
    return [caution.code for caution in motion.cautions if caution.code.startswith("up_axis")]


@pytest.mark.parametrize("axis", sorted(FROM_Y))
def test_a_body_that_stands_in_motion_and_at_rest_is_turned(axis: str) -> None:
    positions = turned(axis)
    found, cautions = judge_up_axis(positions, positions[0], EXPECTED, "y")
    assert found == axis
    assert np.allclose(to_y_up(positions, found), STANDING, atol=1e-6)
    assert [caution.code for caution in cautions] == ["up_axis_guessed"] * (axis != "y")


@pytest.mark.parametrize("axis", sorted(FROM_Y))
@pytest.mark.parametrize("at", [0.0, 0.8, -3.0])
def test_a_walk_shows_what_is_up_against_the_rest_pose(axis: str, at: float) -> None:
    recording = walking()
    positions = turned(axis, recording.positions) + np.float32(at)
    motion = canonicalize(replace(recording, positions=positions.astype(np.float32)))
    assert height_of_head(motion) > 1.2
    assert codes(motion) == ["up_axis_guessed"] * (axis != "y")


@pytest.mark.parametrize("axis", ["z", "-x"])
def test_a_walker_who_bends_down_at_times_is_turned(axis: str) -> None:
    walk = walking()
    positions = walk.positions.copy()
    upper = [ROLES.index(role) for role in (R.CHEST, R.NECK, R.HEAD)]
    hips = positions[:30, [ROLES.index(R.HIPS)]]
    positions[:30, upper] = hips + to_y_up(positions[:30, upper] - hips, "-z")
    seen, cautions = judge_up_axis(turned(axis, positions), None, EXPECTED, "y")
    assert seen == axis
    assert [caution.code for caution in cautions] == ["up_axis_guessed"]


@pytest.mark.parametrize("axis", ["y", "-x"])
def test_legs_alone_stand(axis: str) -> None:
    """Gait laboratories record lower bodies, often with Y up where Z is usual."""
    legs = {r: j for r, j in EXPECTED.items() if "leg" in r or "knee" in r or "foot" in r}
    lower = legs | {R.HIPS: EXPECTED[R.HIPS]}
    seen, cautions = judge_up_axis(turned(axis), None, lower, "z")
    assert seen == axis
    assert [caution.code for caution in cautions] == ["up_axis_guessed"]
    assert judge_up_axis(turned("z"), None, lower, "z") == ("z", ())


def test_a_standing_body_half_below_the_floor_is_turned() -> None:
    """Positions in the axes of a camera have Y down, and their origin anywhere."""
    camera = STANDING * np.array([1, -1, -1], dtype=np.float32) + np.array([0.2, 1.0, 4.0])
    still = replace(without_rest(PERSON), positions=camera.astype(np.float32))
    motion = canonicalize(still)
    assert height_of_head(motion) > 1.2
    assert codes(motion) == ["up_axis_guessed"]


@pytest.mark.parametrize("height", [0.0, 0.15, 0.6])
@pytest.mark.parametrize("has_rest", [True, False])
def test_a_lying_body_stays_lying_with_a_doubt(height: float, has_rest: bool) -> None:
    recording = lying(height) if has_rest else without_rest(lying(height))
    motion = canonicalize(recording)
    assert abs(height_of_head(motion)) < 0.4
    assert codes(motion) == ["up_axis_suspect"]


def test_a_body_that_lies_and_then_stands_up_has_no_doubt() -> None:
    down, up = lying().positions, STANDING
    motion = canonicalize(replace(PERSON, positions=np.concatenate([down] * 5 + [up])))
    assert codes(motion) == []


@pytest.mark.parametrize("name", sorted(PEOPLE))
@pytest.mark.parametrize("axis", ["y", "z"])
def test_the_word_of_the_file_is_never_judged(name: str, axis: str) -> None:
    said = replace(PEOPLE[name], up_axis=axis, is_up_axis_said=True)
    motion = canonicalize(said, roles={R.HIPS: "Hips"})
    assert np.allclose(motion.positions, to_y_up(said.positions, axis), atol=1e-5)
    assert codes(motion) == []


def test_a_body_that_stands_on_its_hands_stays_so() -> None:
    motion = canonicalize(PEOPLE["standing on the hands"])
    assert height_of_head(motion) < -1.0


@pytest.mark.parametrize("name", ["crawling", "crawling in a file of positions", "walking"])
def test_other_postures_keep_the_usual_axis_without_a_doubt(name: str) -> None:
    motion = canonicalize(PEOPLE[name])
    assert np.allclose(motion.positions, PEOPLE[name].positions, atol=1e-5)
    assert codes(motion) == []


@pytest.mark.parametrize("axis", UP_AXES)
def test_the_word_of_the_client_decides(axis: str) -> None:
    motion = canonicalize(replace(lying(), is_up_axis_said=True), up_axis=axis, metres_per_unit=1.0)
    assert np.allclose(motion.positions, to_y_up(lying().positions, axis), atol=1e-6)
    assert codes(motion) == []


def test_an_unknown_axis_is_refused() -> None:
    with pytest.raises(BadField) as refused:
        canonicalize(PERSON, up_axis="w")
    assert refused.value.places[0].location == "up_axis"


def test_the_usual_axis_is_used_without_feet_or_size() -> None:
    assert judge_up_axis(STANDING, STANDING[0], {}, "z") == ("z", ())
    assert judge_up_axis(0 * STANDING, 0 * STANDING[0], EXPECTED, "y") == ("y", ())
