"""Impossible bodies get a caution with the joint and the frames; real bodies get none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution, Recording
from app.numerics.arrays import FloatArray
from tests.motion.plausibility.creatures import PEOPLE, without_rest
from tests.people import CONVENTIONS, ROLES, person
from tests.real_clips import manifest, real_clips

R = JointRole
NAMES = CONVENTIONS["MotionBuilder"]
PLAIN = person(NAMES, frames=60)
CODES = ("limbs_unequal", "bone_length_jumps", "marker_frozen", "sides_suspect")


def cautions(recording: Recording) -> dict[str, Caution]:
    """The doubts about the body by their codes; of several with one code the last."""
    return {c.code: c for c in canonicalize(recording).cautions if c.code in CODES}


def doubts(recording: Recording) -> dict[str, str]:
    """The doubts about the body: the detail by the code."""
    return {code: caution.detail for code, caution in cautions(recording).items()}


def with_positions(positions: FloatArray) -> Recording:
    """The person as a file of positions, whose joints may be anywhere."""
    return replace(without_rest(PLAIN), positions=positions.astype(np.float32))


def column(role: JointRole) -> int:
    return ROLES.index(role)


def exchanged(*parts: str) -> Recording:
    """The person with the left and right joints of some parts exchanged."""
    positions = PLAIN.positions.copy()
    for part in parts:
        left, right = (column(R(f"{side}_{part}")) for side in ("left", "right"))
        positions[:, [left, right]] = PLAIN.positions[:, [right, left]]
    return with_positions(positions)


@pytest.mark.parametrize("name", sorted(PEOPLE))
def test_people_in_all_postures_have_no_doubt(name: str) -> None:
    assert doubts(PEOPLE[name]) == {}
    assert doubts(without_rest(PEOPLE[name])) == {}


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), size=st.sampled_from([0.0, 0.005, 0.015]))
def test_noise_of_markers_is_no_doubt(seed: int, size: float) -> None:
    noise = np.random.default_rng(seed).normal(0, size, PLAIN.positions.shape)
    assert doubts(with_positions(PLAIN.positions + noise)) == {}


@pytest.mark.parametrize("part", ["foot", "knee", "hand", "elbow"])
def test_a_joint_that_lies_at_another_place_makes_limbs_unequal(part: str) -> None:
    positions = PLAIN.positions.copy()
    above = {"foot": "knee", "knee": "upper_leg", "hand": "elbow", "elbow": "shoulder"}[part]
    left, near = column(R(f"left_{part}")), column(R(f"left_{above}"))
    positions[:, left] += 0.5 * (positions[:, near] - positions[:, left])
    found = doubts(with_positions(positions))
    assert NAMES[R(f"left_{part}")] in found["limbs_unequal"]
    assert NAMES[R(f"right_{part}")] in found["limbs_unequal"]


@pytest.mark.parametrize("role", [R.LEFT_KNEE, R.RIGHT_HAND, R.HEAD])
@pytest.mark.parametrize(("first", "count"), [(20, 5), (59, 1), (0, 3)])
def test_a_joint_that_jumps_away_is_named_with_its_frames(
    role: JointRole, first: int, count: int
) -> None:
    positions = PLAIN.positions.copy()
    positions[first : first + count, column(role)] = [4.0, 0.5, -3.0]
    doubt = cautions(with_positions(positions))["bone_length_jumps"]
    detail = doubt.detail
    assert doubt.frames == (first, first + count)
    assert doubt.joint is not None
    assert doubt.joint in detail
    assert NAMES[role] in detail
    where = f"frame {first}" if count == 1 else f"frames {first} to {first + count - 1}"
    assert where in detail


def test_the_worst_of_several_jumps_is_the_place() -> None:
    positions = PLAIN.positions.copy()
    positions[5:8, column(R.HEAD)] += [0.9, 0.0, 0.0]
    positions[30:32, column(R.HEAD)] += [3.0, 0.0, 0.0]
    doubt = cautions(with_positions(positions))["bone_length_jumps"]
    assert (doubt.frames, doubt.joint) == ((30, 32), NAMES[R.HEAD])


def test_arms_that_are_exchanged_turn_the_chest_against_the_hips() -> None:
    found = doubts(exchanged("shoulder", "elbow", "hand"))
    assert "chest and hips" in found["sides_suspect"]
    assert NAMES[R.LEFT_SHOULDER] in found["sides_suspect"]


def test_sides_that_are_exchanged_make_the_feet_point_backward() -> None:
    parts = ("shoulder", "elbow", "hand", "upper_leg", "knee", "foot", "toes")
    assert "backward" in doubts(exchanged(*parts))["sides_suspect"]


def test_a_mirrored_body_is_doubted() -> None:
    """As a Kinect gives it: the right hand of the person is the left one of the picture."""
    mirror = np.array([-1, 1, 1])
    assert "backward" in doubts(with_positions(PLAIN.positions * mirror))["sides_suspect"]


def with_marker(path: FloatArray) -> Recording:
    """The person travels forward beside a marker with a path (frames, 3)."""
    travel = np.zeros((60, 1, 3))
    travel[:, 0, 2] = np.arange(60) / 30
    body = without_rest(PLAIN)
    skeleton = replace(
        body.skeleton,
        names=(*body.skeleton.names, "LFHD"),
        parents=np.append(body.skeleton.parents, -1),
        offsets=np.concatenate([body.skeleton.offsets, path[:1]]),
    )
    positions = np.concatenate([PLAIN.positions + travel, path[:, None]], axis=1)
    return replace(body, skeleton=skeleton, positions=positions.astype(np.float32))


def test_a_marker_that_stays_behind_is_frozen() -> None:
    path = np.zeros((60, 3))
    path[:, 2] = np.minimum(np.arange(60), 40) / 30
    doubt = cautions(with_marker(path))["marker_frozen"]
    assert (doubt.frames, doubt.joint) == ((40, 60), "LFHD")
    assert "LFHD does not move in frames 40 to 59" in doubt.detail


def test_an_object_that_never_moves_is_no_frozen_marker() -> None:
    assert doubts(with_marker(np.ones((60, 3)))) == {}


def test_a_person_who_stands_still_has_no_frozen_markers() -> None:
    still = np.repeat(PLAIN.positions[:1], 60, axis=0)
    assert doubts(with_positions(still)) == {}


@pytest.mark.slow
def test_at_most_one_in_a_hundred_real_clips_is_doubted() -> None:
    """No caution but those of formats is raised for more than 1 % of clips at their true rates."""
    counts: dict[str, list[str]] = {}
    rows = manifest()
    for row in rows:
        path = real_clips() / row["path"]
        skeleton = None
        if path.suffix == ".amc":
            skeleton = next(path.parent.glob("*.asf")).read_bytes()
        recording = read_recording(path.read_bytes(), skeleton)
        for caution in canonicalize(recording, frame_rate=float(row["fps"])).cautions:
            counts.setdefault(caution.code, []).append(row["path"])
    assert {code: paths for code, paths in counts.items() if len(paths) > len(rows) / 100} == {}
