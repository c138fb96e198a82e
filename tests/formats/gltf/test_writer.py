"""GLB files have the motion as nodes, skin and animation, by the specification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.formats.gltf.writer import write_glb
from app.motion.canonical.canonical import canonicalize
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.skeleton.animation import Animation, animation_of_positions, animation_of_rotations
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.formats.gltf.files import Glb, Validator
from tests.people import CONVENTIONS, person


def a_person(frames: int = 30) -> Animation:
    recording = person(CONVENTIONS["MotionBuilder"], frames=frames, seed=1)
    assert recording.rotations is not None
    skeleton = replace(
        recording.skeleton, end_parents=np.array([3]), end_offsets=np.array([[0, 0.2, 0]])
    )
    return animation_of_rotations(skeleton, recording.rotations, recording.positions, 30.0)


def stretching() -> Animation:
    positions = np.random.default_rng(0).normal(size=(10, 6, 3)).astype(np.float32)
    parents = np.array([-1, 0, 1, 0, -1, 4])
    return animation_of_positions([f"{i} \"'{{" for i in range(6)], parents, positions, 29.97)


def markers() -> Animation:
    positions = np.random.default_rng(0).normal(size=(10, 5, 3)).astype(np.float32)
    return animation_of_positions(["same"] * 5, np.full(5, -1), positions, 120.0)


def one_still_joint() -> Animation:
    return animation_of_positions(["a"], np.array([-1]), np.ones((1, 1, 3), np.float32), 30.0)


def on_one_body() -> Animation:
    return on_canonical_body(canonicalize(person(CONVENTIONS["SMPL"])))


ANIMATIONS = {f.__name__: f for f in (a_person, stretching, markers, one_still_joint, on_one_body)}


@pytest.mark.parametrize("name", ANIMATIONS)
def test_nodes_have_the_positions_of_the_joints_at_each_key(name: str) -> None:
    animation = ANIMATIONS[name]()
    glb = Glb(write_glb(animation))
    joints = len(animation.skeleton)
    expected = animation.positions()
    found = glb.world()[:, :joints, :3, 3]
    assert np.abs(found - expected).max() < 1e-5
    assert [node["name"] for node in glb.document["nodes"][:joints]] == list(
        animation.skeleton.names
    )


def test_keys_have_the_times_of_the_frames() -> None:
    times = Glb(write_glb(stretching())).times()
    np.testing.assert_allclose(times, np.arange(10) / 29.97, rtol=1e-6)


@pytest.mark.parametrize("name", ["a_person", "stretching", "on_one_body"])
def test_sticks_start_and_end_at_joints_in_all_poses(name: str) -> None:
    animation = ANIMATIONS[name]()
    glb = Glb(write_glb(animation))
    corners, positions = glb.skinned(), animation.positions()
    joints = len(positions[0])
    marks = corners[:, : 6 * joints].reshape(len(corners), joints, 6, 3)
    np.testing.assert_allclose(marks.mean(axis=2), positions, atol=1e-5)
    sticks = corners[:, 6 * joints :].reshape(len(corners), -1, 6, 3)
    bones = [(p, j) for j, p in enumerate(animation.skeleton.parents) if p >= 0]
    for stick, (parent, joint) in enumerate(bones):
        np.testing.assert_allclose(sticks[:, stick, 0], positions[:, parent], atol=1e-5)
        np.testing.assert_allclose(sticks[:, stick, 5], positions[:, joint], atol=1e-5)
    assert sticks.shape[1] == len(bones) + len(animation.skeleton.end_parents)


def test_triangles_face_outward() -> None:
    glb = Glb(write_glb(a_person(2)))
    (primitive,) = glb.document["meshes"][0]["primitives"]
    corners = glb.array(primitive["attributes"]["POSITION"]).astype(float)
    triangles = glb.array(primitive["indices"]).astype(int).reshape(-1, 8, 3)
    for shape in triangles:
        middle = corners[np.unique(shape)].mean(axis=0)
        for a, b, c in corners[shape]:
            assert np.dot(np.cross(b - a, c - a), (a + b + c) / 3 - middle) > 0


def test_joints_that_do_not_move_are_not_animated() -> None:
    animation = a_person(40)
    still = replace(animation, rotations=np.repeat(animation.rotations[:1], 40, axis=0))
    assert "animations" not in Glb(write_glb(replace(still, translations=_still(still)))).document
    (written,) = Glb(write_glb(animation)).document["animations"]
    moved = [c["target"]["node"] for c in written["channels"] if c["target"]["path"] != "rotation"]
    assert moved == []


def _still(animation: Animation) -> FloatArray:
    return np.repeat(animation.translations[:1], len(animation.translations), axis=0)


def test_quaternions_have_unit_length_and_never_jump() -> None:
    glb = Glb(write_glb(stretching()))
    (animation,) = glb.document["animations"]
    for channel in animation["channels"]:
        if channel["target"]["path"] == "rotation":
            turns = glb.array(animation["samplers"][channel["sampler"]]["output"])
            np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1, atol=1e-6)
            assert (np.sum(turns[1:] * turns[:-1], axis=1) >= 0).all()


def test_the_license_is_written() -> None:
    document = Glb(write_glb(a_person(10), "a clip", "CC-BY-4.0")).document
    assert document["asset"]["copyright"] == "CC-BY-4.0"
    assert document["animations"][0]["name"] == "a clip"


def test_hundreds_of_joints_are_written() -> None:
    joints = 400
    skeleton = Skeleton(
        tuple(f"j{i}" for i in range(joints)), np.arange(joints) - 1, np.full((joints, 3), 0.01)
    )
    rest = np.cumsum(skeleton.offsets, axis=0)[None].repeat(2, axis=0).astype(np.float32)
    glb = Glb(write_glb(animation_of_positions(skeleton.names, skeleton.parents, rest, 30.0)))
    assert np.abs(glb.world()[0, :joints, :3, 3] - rest[0]).max() < 1e-3


@pytest.mark.slow
def test_the_khronos_validator_finds_no_error(tmp_path_factory: pytest.TempPathFactory) -> None:
    validator = Validator(tmp_path_factory.mktemp("gltf"))
    assert validator.messages(write_glb(a_person())[:-4]) != []
    for name, make in ANIMATIONS.items():
        assert validator.messages(write_glb(make(), "a clip", "CC0-1.0")) == [], name
