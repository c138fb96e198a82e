"""GLB, glTF and VRM files are read by the specification, or refused."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from app.errors import BadField, FormatNotSupported
from app.formats.gltf.reader import read_gltf
from app.formats.gltf.writer import write_glb
from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.formats.gltf.documents import Document
from tests.formats.gltf.test_writer import ANIMATIONS, a_person

CHAIN = [
    {"name": "hips", "children": [1]},
    {"name": "knee", "translation": [0, -1, 0], "children": [2]},
    {"name": "foot", "translation": [0, -1, 0]},
]
FRAMES = 13
TIMES = (np.arange(FRAMES) / 24).astype("<f4")[:, None]


def turns(seed: int = 0, count: int = FRAMES) -> FloatArray:
    """(count, 4) unit quaternions x y z w, near each other."""
    steps = np.random.default_rng(seed).normal(scale=0.3, size=(count, 3))
    return Rotation.from_rotvec(np.cumsum(steps, axis=0)).as_quat()


def chain(values: FloatArray | None = None, nodes: list[dict[str, Any]] | None = None) -> Document:
    """A leg whose hips turn, at 24 keys a second."""
    document = Document(nodes or [dict(node) for node in CHAIN])
    numbers = (turns() if values is None else values).astype("<f4")
    document.animate([(0, "rotation", document.array(TIMES), document.array(numbers))])
    return document


def foot(recording: Recording) -> FloatArray:
    return recording.positions[:, recording.skeleton.names.index("foot")]


@pytest.mark.parametrize("name", [n for n in ANIMATIONS if n != "one_still_joint"])
def test_files_of_the_writer_are_read_back(name: str) -> None:
    animation = ANIMATIONS[name]()
    recording = read_recording(write_glb(animation))
    assert (recording.format, recording.up_axis, recording.metres_per_unit) == ("glb", "y", 1.0)
    assert recording.frame_rate == pytest.approx(animation.frame_rate, rel=1e-6)
    assert recording.skeleton.names == animation.skeleton.names
    assert np.abs(recording.positions - animation.positions()).max() < 1e-5


@pytest.mark.parametrize("late", [0.0, 2.5])
def test_the_time_of_the_first_key_is_kept(late: float) -> None:
    document = Document([dict(node) for node in CHAIN])
    times, values = TIMES + np.float32(late), turns().astype("<f4")
    document.animate([(0, "rotation", document.array(times), document.array(values))])
    recording = read_gltf(document.glb())
    assert recording.start_frame == pytest.approx(late * 24)
    assert len(recording.positions) == FRAMES


def test_who_flies_lies_in_the_air() -> None:
    """The specification says that Y is up, so the posture says nothing about it."""
    animation = a_person()
    rotations, translations = animation.rotations.copy(), animation.translations.copy()
    rotations[:, 0] = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]
    translations[:, 0, 1] += 5
    flying = replace(animation, rotations=rotations, translations=translations)
    motion = canonicalize(read_recording(write_glb(flying)))
    assert motion.cautions == ()
    head, foot = (motion.positions[:, motion.roles[JointRole(r)]] for r in ("head", "left_foot"))
    assert np.abs((head - foot)[:, 1]).mean() < 0.5


def test_a_person_keeps_roles_and_rotations() -> None:
    animation = a_person()
    recording = read_recording(write_glb(animation))
    assert recording.rotations is not None
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    # Turns relative to the first frame do not depend on the rest pose.
    ours, theirs = (
        Rotation.from_quat(quaternions[:, 0][:, [1, 2, 3, 0]])
        for quaternions in (recording.rotations, animation.rotations)
    )
    assert (ours * ours[0].inv() * theirs[0] * theirs.inv()).magnitude().max() < 1e-3


def test_rotations_turn_the_joints_below() -> None:
    recording = read_gltf(chain().glb())
    assert recording.frame_rate == 24
    expected = Rotation.from_quat(turns()).apply([0, -2, 0])
    assert np.allclose(foot(recording), expected, atol=1e-5)


def test_json_with_base64_is_the_same_file() -> None:
    document = chain()
    assert sniff(document.gltf()) == "gltf"
    first, second = read_recording(document.glb()), read_recording(document.gltf())
    assert np.array_equal(first.positions, second.positions)


def test_numbers_in_another_file_are_refused() -> None:
    with pytest.raises(FormatNotSupported, match="GLB"):
        read_recording(chain().gltf(uri="walk.bin"))


def test_an_armature_scales_and_turns_the_body() -> None:
    to_y_up = Rotation.from_euler("x", -90, degrees=True)
    armature = {
        "name": "Armature", "scale": [0.01] * 3, "rotation": to_y_up.as_quat().tolist(),
        "children": [1],
    }  # fmt: skip
    nodes = [armature, *({**n, "children": [c + 1 for c in n.get("children", [])]} for n in CHAIN)]
    document = Document(nodes)
    values = document.array(turns().astype("<f4"))
    document.animate([(1, "rotation", document.array(TIMES), values)])
    document.json["skins"] = [{"joints": [1, 2, 3]}]
    recording = read_gltf(document.glb())
    assert recording.skeleton.names == ("hips", "knee", "foot")
    expected = 0.01 * to_y_up.apply(Rotation.from_quat(turns()).apply([0, -2, 0]))
    assert np.allclose(foot(recording), expected, atol=1e-6)


def test_a_matrix_is_a_translation_a_rotation_and_a_scale() -> None:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("y", 90, degrees=True).as_matrix() * 2
    matrix[:3, 3] = [3, 0, 0]
    nodes = [{"matrix": matrix.T.ravel().tolist(), "children": [1]}]
    nodes += [{**n, "children": [c + 1 for c in n.get("children", [])]} for n in CHAIN]  # type: ignore[list-item]
    document = Document(nodes)
    values = document.array(turns().astype("<f4"))
    document.animate([(1, "rotation", document.array(TIMES), values)])
    local = Rotation.from_quat(turns()).apply([0, -2, 0])
    expected = local @ matrix[:3, :3].T + [3, 0, 0]
    assert np.allclose(foot(read_gltf(document.glb())), expected, atol=1e-5)


@pytest.mark.parametrize("gap", [0, 4])
@pytest.mark.parametrize(("dtype", "atol"), [("<i2", 1e-3), ("<i1", 5e-2)])
def test_integers_stand_for_fractions(dtype: str, atol: float, gap: int) -> None:
    document = Document([dict(node) for node in CHAIN])
    largest = np.iinfo(dtype).max
    values = document.array(np.round(turns() * largest).astype(dtype), normalized=True, gap=gap)
    document.animate([(0, "rotation", document.array(TIMES, gap=gap), values)])
    expected = Rotation.from_quat(turns()).apply([0, -2, 0])
    assert np.allclose(foot(read_gltf(document.glb())), expected, atol=2 * atol)


def test_sparse_arrays_replace_some_elements() -> None:
    values = turns()
    base = values.copy()
    base[[3, 7]] = [0, 0, 0, 1]
    document = chain(base)
    where = document.view(np.array([3, 7], "<u2").tobytes())
    what = document.view(values[[3, 7]].astype("<f4").tobytes())
    document.json["accessors"][1]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": where, "componentType": 5123},
        "values": {"bufferView": what},
    }
    assert np.allclose(foot(read_gltf(document.glb())), foot(read_gltf(chain().glb())), atol=1e-6)


KEYS = np.array([0.0, 0.5, 1.25, 2.0])


def sparse_keys(values: FloatArray, path: str, interpolation: str) -> Recording:
    document = Document([dict(node) for node in CHAIN])
    times = document.array(KEYS.astype("<f4")[:, None])
    document.animate(
        [(0, path, times, document.array(values.astype("<f4")))], interpolation=interpolation
    )
    return read_gltf(document.glb())


def test_rotations_between_keys_follow_the_shortest_arc() -> None:
    values = turns(1, len(KEYS))
    values[2] *= -1
    recording = sparse_keys(values, "rotation", "LINEAR")
    assert recording.frame_rate == 24
    seconds = np.clip(np.arange(len(recording.positions)) / 24, 0, 2)
    expected = Slerp(KEYS, Rotation.from_quat(values))(seconds).apply([0, -2, 0])
    assert np.allclose(foot(recording), expected, atol=1e-5)


def test_splines_have_the_tangents_of_their_keys() -> None:
    rng = np.random.default_rng(2)
    before, value, after = rng.normal(size=(3, len(KEYS), 3))
    values = np.stack([before, value, after], axis=1).reshape(-1, 3)
    recording = sparse_keys(values, "translation", "CUBICSPLINE")
    seconds = np.clip(np.arange(len(recording.positions)) / 24, 0, 2)
    for left in range(len(KEYS) - 1):
        inside = (seconds >= KEYS[left]) & (seconds < KEYS[left + 1])
        spline = CubicHermiteSpline(
            KEYS[left : left + 2], value[left : left + 2], [after[left], before[left + 1]]
        )
        expected = np.add(spline(seconds[inside]), [0, -2, 0])
        assert np.allclose(foot(recording)[inside], expected, atol=1e-4)


def test_steps_keep_their_value() -> None:
    values = np.arange(12.0).reshape(4, 3)
    recording = sparse_keys(values, "translation", "STEP")
    assert np.allclose(foot(recording)[:12], values[0] + [0, -2, 0])
    assert np.allclose(foot(recording)[-1], values[-1] + [0, -2, 0])


def test_the_longest_animation_is_read_unless_one_is_named() -> None:
    document = chain()
    short = document.array(turns(5, 4).astype("<f4"))
    document.animate([(0, "rotation", document.array(TIMES[:4]), short)], name="turn")
    recording = read_recording(document.glb())
    assert (len(recording.positions), recording.cautions[0].code) == (FRAMES, "stack_chosen")
    assert len(read_recording(document.glb(), stack="turn").positions) == 4
    with pytest.raises(BadField, match="walk, turn"):
        read_recording(document.glb(), stack="run")


HUMAN = {"hips": 0, "leftUpperLeg": 1, "leftLowerLeg": 2}


@pytest.mark.parametrize("version", [0, 1])
def test_human_bones_of_vrm_are_the_names_of_joints(version: int) -> None:
    document = chain(nodes=[{**node, "name": f"J_{i}"} for i, node in enumerate(CHAIN)])
    listed = [{"bone": bone, "node": node} for bone, node in HUMAN.items()]
    by_bone = {bone: {"node": node} for bone, node in HUMAN.items()}
    extension = {"humanoid": {"humanBones": by_bone if version else listed}}
    document.json["extensions"] = {"VRMC_vrm" if version else "VRM": extension}
    assert read_gltf(document.glb()).skeleton.names == tuple(HUMAN)


def test_nodes_of_objects_are_left_out() -> None:
    nodes = [*({**node} for node in CHAIN), {"name": "ball"}, {"name": "camera"}]
    document = chain(nodes=nodes)
    document.json["skins"] = [{"joints": [0, 2]}]
    recording = read_gltf(document.glb())
    assert recording.skeleton.names == ("hips", "knee", "foot")


def test_the_body_that_moves_is_read() -> None:
    still = [{**n, "children": [c + 3 for c in n.get("children", [])]} for n in CHAIN]
    document = chain(nodes=[*({**node} for node in CHAIN), *still])
    times, values = 0, document.array(turns(3).astype("<f4"))
    document.animate([(n, "rotation", times, values) for n in (3, 4, 5)])
    document.json["skins"] = [{"joints": [0, 1, 2]}, {"joints": [3, 4, 5]}]
    recording = read_gltf(document.glb())
    assert recording.cautions == ()
    assert np.ptp(foot(recording), axis=0).max() > 0.1


@settings(max_examples=30, deadline=None)
@given(st.integers(10, 240), st.integers(2, 40), st.floats(0, 100))
def test_the_rate_is_that_of_the_keys(rate: int, frames: int, start: float) -> None:
    document = Document([dict(node) for node in CHAIN])
    times = (start + np.arange(frames + 1) / rate).astype("<f4")[:, None]
    values = document.array(turns(0, frames + 1).astype("<f4"))
    document.animate([(0, "rotation", document.array(times), values)])
    recording = read_gltf(document.glb())
    assert recording.frame_rate == pytest.approx(rate, rel=2e-3)
    assert abs(len(recording.positions) - frames - 1) <= 1


def test_roles_of_a_vrm_person_are_those_of_the_specification() -> None:
    animation = a_person()
    content = write_glb(animation)
    size = struct.unpack_from("<I", content, 12)[0]
    document = json.loads(content[20 : 20 + size])
    bones = {"leftUpperLeg": "LeftUpLeg", "leftLowerLeg": "LeftLeg", "hips": "Hips"}
    names = [node["name"] for node in document["nodes"]]
    document["extensions"] = {
        "VRMC_vrm": {
            "humanoid": {"humanBones": {b: {"node": names.index(n)} for b, n in bones.items()}}
        }
    }
    text = json.dumps(document).encode()
    changed_content = (
        struct.pack("<4sIII4s", b"glTF", 2, 0, len(text), b"JSON") + text + content[20 + size :]
    )
    motion = canonicalize(read_recording(changed_content))
    assert motion.names[motion.roles[JointRole.LEFT_KNEE]] == "leftLowerLeg"
