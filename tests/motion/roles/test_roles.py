"""Roles by client, name and shape. Left stays left, also for a mirrored body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import BadField
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.roles import find_roles, given_roles
from app.motion.roles.topology import roles_by_shape
from app.motion.skeleton.recording import Recording
from tests.people import CONVENTIONS, ROLES, person
from tests.real_clips import real_clips

R = JointRole
EXPECTED = {role: index for index, role in enumerate(ROLES)}


def roles_of(recording: Recording) -> dict[JointRole, int]:
    skeleton = recording.skeleton
    return find_roles(skeleton.names, skeleton.parents, recording.positions)


@pytest.mark.parametrize("convention", sorted(CONVENTIONS))
def test_every_convention_gives_every_role(convention: str) -> None:
    assert roles_of(person(CONVENTIONS[convention])) == EXPECTED


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), yaw=st.floats(-3, 3), scale=st.sampled_from([0.01, 1, 100]))
def test_shape_alone_gives_roles_for_any_heading(seed: int, yaw: float, scale: float) -> None:
    recording = person(seed=seed, scale=scale)
    c, s = np.cos(yaw), np.sin(yaw)
    turned = recording.positions @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    assert roles_by_shape(recording.skeleton.parents, turned) == EXPECTED


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_mirrored_shape_has_mirrored_sides(seed: int) -> None:
    recording = person(seed=seed)
    mirrored = recording.positions * np.array([-1, 1, 1], dtype=np.float32)
    expected = {role.mirrored(): joint for role, joint in EXPECTED.items()}
    assert roles_by_shape(recording.skeleton.parents, mirrored) == expected


def test_names_have_priority_over_a_mirrored_shape() -> None:
    recording = person(CONVENTIONS["MotionBuilder"])
    mirrored = recording.positions * np.array([-1, 1, 1], dtype=np.float32)
    assert roles_of(replace(recording, positions=mirrored)) == EXPECTED


def test_shape_adds_roles_on_the_sides_given_by_names() -> None:
    names = {role: name for role, name in CONVENTIONS["DAZ"].items() if "ARM" not in name.upper()}
    names = {role: name for role, name in names.items() if role not in (R.LEFT_KNEE, R.HEAD)}
    recording = person(names)
    assert roles_of(recording) == EXPECTED
    mirrored = recording.positions * np.array([-1, 1, 1], dtype=np.float32)
    assert roles_of(replace(recording, positions=mirrored)) == EXPECTED


def test_a_root_above_the_hips_is_not_the_hips() -> None:
    recording = person(CONVENTIONS["Bandai Namco"])
    names = ("joint_Root", *recording.skeleton.names)
    parents = np.concatenate([[-1], recording.skeleton.parents + 1])
    positions = np.concatenate([0 * recording.positions[:, :1], recording.positions], axis=1)
    assert find_roles(names, parents, positions)[R.HIPS] == 1
    nameless = [f"j{i}" for i in range(len(names))]
    assert find_roles(nameless, parents, positions)[R.HIPS] == 1


def test_a_body_without_arms_has_trunk_and_legs() -> None:
    recording = person()
    keep = [i for i, role in enumerate(ROLES) if not role.endswith(("shoulder", "elbow", "hand"))]
    renumber = {old: new for new, old in enumerate(keep)}
    parents = np.array([renumber.get(int(recording.skeleton.parents[i]), -1) for i in keep])
    found = roles_by_shape(parents, recording.positions[:, keep])
    legs = {role: joint for role, joint in found.items() if role in EXPECTED and role != R.CHEST}
    assert {R.HIPS, R.NECK, R.LEFT_KNEE, R.RIGHT_FOOT} <= set(legs)
    assert legs == {role: renumber[EXPECTED[role]] for role in legs}


@pytest.mark.parametrize("parents", [[-1], [-1, 0, 1, 2], [-1, -1, -1], [-1, 0, 0, 0, 0]])
def test_other_trees_have_no_legs(parents: list[int]) -> None:
    positions = np.random.default_rng(0).normal(size=(5, len(parents), 3))
    found = find_roles(["x"] * len(parents), np.array(parents), positions)
    assert R.LEFT_KNEE not in found


def test_a_body_without_size_has_no_roles_by_shape() -> None:
    recording = person()
    assert R.LEFT_KNEE not in roles_of(replace(recording, positions=0 * recording.positions))


def test_the_mapping_of_the_client_is_used() -> None:
    recording = person(CONVENTIONS["DAZ"])
    names = recording.skeleton.names
    said = given_roles(names, {"left_hand": "lForeArm", "hips": "chest"})
    given = {role: joint for role, (joint,) in said.items()}
    found = find_roles(names, recording.skeleton.parents, recording.positions, given)
    assert found[R.LEFT_HAND] == names.index("lForeArm")
    assert found[R.HIPS] == names.index("chest")
    assert found.get(R.LEFT_ELBOW) != names.index("lForeArm")


@pytest.mark.parametrize(
    ("mapping", "location"),
    [
        ({"tail": "hip"}, "roles.tail"),
        ({"hips": "nowhere"}, "roles.hips"),
        ({"hips": "twice"}, "roles.hips"),
    ],
)
def test_a_mapping_that_does_not_fit_is_refused(mapping: dict[str, str], location: str) -> None:
    with pytest.raises(BadField) as caught:
        given_roles(["hip", "twice", "twice"], mapping)
    assert [place.location for place in caught.value.places] == [location]


@pytest.mark.parametrize(
    "path",
    [
        "bandai-namco-1/dash_active_001.bvh",
        "bandai-namco-2/walk_normal_001.bvh",
        "cmu-bvh/02_01.bvh",
        "cmu-bvh/07_01.bvh",
        "cmu-daz/martial_04.bvh",
    ],
)
def test_shape_agrees_with_names_on_real_clips(path: str) -> None:
    from app.formats.bvh.reader import read_bvh

    recording = read_bvh((real_clips() / path).read_bytes())
    by_name, parents = roles_of(recording), recording.skeleton.parents
    by_shape = roles_by_shape(parents, recording.positions)
    apart = [
        role
        for role in by_name
        if not np.allclose(
            recording.positions[:, by_name[role]], recording.positions[:, by_shape[role]]
        )
    ]
    assert not apart
