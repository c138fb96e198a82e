"""The nodes of an FBX file that are the body, unsupported files, and real clips."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported, TooLarge, Unreadable
from app.formats.fbx.reader import read_fbx
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import SUN_ROLES
from tests.formats.fbx.files import CONSTANT, LINEAR, NEXT, Bone, Curve, Record, Take, fbx
from tests.formats.fbx.takes import (
    CHAIN,
    FRAMES,
    LEFT_HANDED,
    RIGHT_HANDED,
    SWAY,
    WALK,
    changed,
    clip,
    consistent,
    curves,
    expected,
    person_bones,
    turning,
)
from tests.people import CONVENTIONS
from tests.real_clips import real_clips


def test_nodes_above_the_body_carry_it() -> None:
    armature = {"Lcl Rotation": (-90.0, 0.0, 0.0), "Lcl Scaling": (100.0, 100.0, 100.0)}
    bones = [Bone("Scene", -1, armature, "Null")]
    bones += [replace(bone, parent=bone.parent + 1) for bone in CHAIN]
    animated = {(bone + 1, name): values for (bone, name), values in SWAY.items()}
    recording = read_fbx(clip(bones, animated))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")
    assert np.allclose(recording.positions, expected(bones, animated)[:, 1:], rtol=1e-5, atol=1e-2)


def test_a_moving_null_that_carries_the_body_is_a_joint() -> None:
    bones = [Bone("Reference", -1, {}, "Null")]
    bones += [replace(bone, parent=bone.parent + 1) for bone in CHAIN]
    animated = {(0, "Lcl Translation"): np.linspace([0, 0, 0], [50, 0, 10], FRAMES)}
    recording = read_fbx(clip(bones, animated))
    assert recording.skeleton.names == ("Reference", "Hips", "Spine", "Head")
    assert np.allclose(recording.positions, expected(bones, animated), atol=1e-3)


def test_a_body_of_moving_nulls() -> None:
    bones = [replace(bone, subtype="Null") for bone in CHAIN[:2]]
    recording = read_fbx(clip(bones))
    assert recording.skeleton.names == ("Hips", "Spine")


def test_the_skeleton_with_the_most_moving_joints_is_read() -> None:
    bones = [Bone("Prop"), Bone("Tip", 0), Bone("Handle", 1), Bone("Grip", 2)]
    bones += [replace(b, parent=b.parent + 4 if b.parent >= 0 else -1) for b in CHAIN]
    animated = {(bone + 4, name): values for (bone, name), values in SWAY.items()}
    animated[0, "Lcl Rotation"] = np.linspace([0, 0, 0], [1, 2, 3], FRAMES)
    recording = read_fbx(clip(bones, animated))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")
    assert [caution.code for caution in recording.cautions] == ["skeleton_chosen"]


def test_meshes_are_ignored() -> None:
    bones = [*CHAIN, Bone("Shirt", -1, {}, "Mesh"), Bone("Camera", 2, {}, "Camera")]
    recording = read_fbx(clip(bones))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")


@pytest.mark.parametrize(
    ("bones", "take", "location"),
    [
        (CHAIN, [], "AnimationStack"),
        (CHAIN, [Take("t", [{}])], "AnimationCurve"),
        ([Bone("Cube", -1, {}, "Mesh")], [WALK], "Model"),
        ([Bone("A", 1), Bone("B", 0)], [WALK], "Model 100"),
        (CHAIN, [turning(Curve([1, 0], [0, 0]))], "AnimationCurve 1000003"),
        (CHAIN, [turning(Curve([0, 1], [0]))], "AnimationCurve 1000003"),
        (CHAIN, [turning(Curve([0, 1], [0, np.nan]))], "AnimationCurve 1000003"),
        (CHAIN, [turning(Curve([0, 1], [0, 1], [4], [[0] * 4] * 3))], "AnimationCurve 1000003"),
        (changed(1, {"Lcl Translation": (1.0, np.inf, 0.0)}), [WALK], "Model 101"),
        (changed(1, {"PreRotation": (1.0, 2.0), "RotationActive": 1}), [WALK], "Model 101"),
        (changed(1, {"Lcl Scaling": (1e9, 1e9, 1e9)}), [WALK], "Model"),
    ],
)
def test_an_unreadable_node_is_named_in_the_error(
    bones: list[Bone], take: list[Take], location: str
) -> None:
    with pytest.raises(Unreadable) as caught:
        read_fbx(fbx(bones, take))
    (found,) = caught.value.places
    assert found.location.startswith("node Objects/")
    assert location in found.location
    assert "expected" in found.message


REPEATED = {
    "X": Curve(
        [0, 0.1],
        [0, 9],
        extra=(Record("Post-Extrapolation", [], [Record("Type", [b"R"])]),),
    )
}


def big_endian(version: int) -> bytes:
    content = bytearray(clip())
    content[22] = 1
    content[23:27] = version.to_bytes(4, "big")
    return bytes(content)


def test_zero_bytes_that_became_spaces_are_named() -> None:
    with pytest.raises(Unreadable, match="version control") as caught:
        read_fbx(clip().replace(b"\0", b" "))
    assert caught.value.places[0].location == "byte 20"


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"; FBX 7.4.0 project file\n", "without a version"),
        (b"; FBX 5.0.0 project file\nFBXHeaderExtension: {\nFBXVersion: 5000\n}", "5.0"),
        (clip(version=5800), "5.8"),
        (clip(version=8000), "8.0"),
        (big_endian(7400), "big-endian FBX 7.4"),
        (clip(header=[Record("OtherFlags", [], [Record("TCDefinition", [0])])]), "OtherFlags"),
        (clip().replace(b"EncryptionTypeI\0", b"EncryptionTypeI\1"), "encrypted"),
        (clip(changed(1, {"RotationActive": 1, "RotationOrder": 6})), "order"),
        (clip(changed(1, {"InheritType": 3})), "inherit"),
        (clip(CHAIN, {**SWAY, (1, "PreRotation"): SWAY[1, "Lcl Rotation"]}), "PreRotation"),
        (fbx(CHAIN, [Take("t", [curves(SWAY), curves(SWAY)])]), "layer"),
        (fbx(CHAIN, [Take("t", [{**curves(SWAY), (2, "Lcl Rotation"): REPEATED}])]), "Extrapola"),
    ],
)
def test_unsupported_files_are_refused_by_name(content: bytes, word: str) -> None:
    with pytest.raises(FormatNotSupported, match=word):
        read_fbx(content)


def test_layers_without_edits_and_muted_layers_are_ignored() -> None:
    neutral = {(1, "Lcl Rotation"): {"X": Curve([0, 1], [0, 0])}}
    recording = read_fbx(fbx(CHAIN, [Take("t", [curves(SWAY), neutral])], settings={"TimeMode": 6}))
    assert np.allclose(recording.positions, expected(CHAIN), atol=1e-3)


@pytest.mark.parametrize(("flags", "value"), [(CONSTANT, 10.0), (NEXT, 50.0), (LINEAR, 30.0)])
def test_steps(flags: int, value: float) -> None:
    turn = {(1, "Lcl Rotation"): {"Z": Curve([0, 2 / 30, 4 / 30], [10, 50, 50], flags)}}
    recording = read_fbx(fbx(CHAIN, [Take("t", [turn])], settings={"TimeMode": 6}))
    degrees = np.array([[0, 0, v] for v in (10, value, 50, 50, 50)])
    assert np.allclose(
        recording.positions, expected(CHAIN, {(1, "Lcl Rotation"): degrees}), atol=1e-3
    )


def test_a_single_far_key_does_not_use_memory() -> None:
    far = {(1, "Lcl Rotation"): {"Z": Curve([0, 1e8], [10, 50])}}
    with pytest.raises(TooLarge):
        read_fbx(fbx(CHAIN, [Take("t", [far])], settings={"TimeMode": 6}))


@pytest.mark.parametrize("convention", ["MotionBuilder", "Mixamo", "Unreal", "3ds Max"])
@pytest.mark.parametrize("axes", [*RIGHT_HANDED[:2], LEFT_HANDED[0]])
def test_a_person_becomes_a_canonical_motion(convention: str, axes: dict[str, int]) -> None:
    bones = person_bones(CONVENTIONS[convention])
    # The person stands along Y. A node above turns it to the axes of the file.
    turn = np.zeros((3, 3))
    for row, name in enumerate(("CoordAxis", "UpAxis", "FrontAxis")):
        turn[row, axes[name]] = axes[f"{name}Sign"]
    bones = [
        replace(b, properties={"Lcl Translation": tuple(turn.T @ b.properties["Lcl Translation"])})
        for b in bones
    ]
    animated = {(1, "Lcl Rotation"): np.linspace([0, 0, 0], [3, 2, 1], 40)}
    motion = canonicalize(read_fbx(clip(bones, animated, settings={"TimeMode": 6, **axes})))
    assert set(SUN_ROLES) <= set(motion.roles)
    assert motion.missing_roles == ()
    left = motion.positions[:, motion.roles[SUN_ROLES[0]]]
    right = motion.positions[:, motion.roles[SUN_ROLES[1]]]
    assert np.all(left[:, 0] > right[:, 0])
    assert motion.positions[..., 1].min() > -0.1
    assert 1.3 < np.ptp(motion.positions[0, :, 1]) < 1.9


VECTOR = st.tuples(*[st.floats(-180, 180, width=32)] * 3)


@st.composite
def skeletons(draw: st.DrawFn) -> list[Bone]:
    count = draw(st.integers(1, 6))
    return [
        Bone(
            f"b{index}",
            draw(st.integers(0, index - 1)) if index else -1,
            {
                "Lcl Translation": draw(VECTOR),
                "Lcl Rotation": draw(VECTOR),
                "RotationActive": draw(st.integers(0, 1)),
                "RotationOrder": draw(st.integers(0, 5)),
                "PreRotation": draw(VECTOR),
                "PostRotation": draw(VECTOR),
                "RotationPivot": draw(VECTOR),
                "RotationOffset": draw(VECTOR),
                "ScalingPivot": draw(VECTOR),
                "ScalingOffset": draw(VECTOR),
                "InheritType": draw(st.integers(0, 2)),
                "Lcl Scaling": (draw(st.sampled_from([1.0, 0.5, 2.0])),) * 3,
            },
        )
        for index in range(count)
    ]


@settings(max_examples=40, deadline=None)
@given(bones=skeletons(), seed=st.integers(0, 2**32 - 1), wide=st.booleans())
def test_any_written_file_is_read(bones: list[Bone], seed: int, wide: bool) -> None:
    rng = np.random.default_rng(seed)
    animated = {
        (index, name): rng.uniform(-180, 180, (4, 3)).astype(np.float32).astype(float)
        for index in range(len(bones))
        for name in ("Lcl Rotation", "Lcl Translation")
    }
    recording = read_fbx(clip(bones, animated, version=7500 if wide else 7400))
    order = [bones.index(next(b for b in bones if b.name == n)) for n in recording.skeleton.names]
    truth = expected(bones, animated)[:, order]
    assert np.allclose(recording.positions, truth, rtol=1e-5, atol=1e-5 * np.abs(truth).max())


def test_real_clips() -> None:
    files = sorted((real_clips() / "cmu-fbx").glob("*.fbx"))
    assert files
    for file in files:
        recording = read_recording(file.read_bytes())
        motion = canonicalize(recording)
        assert motion.missing_roles == ()
        assert motion.frame_rate == 30
        assert motion.metres_per_unit == 0.01
        heights = motion.positions[..., 1]
        assert -0.1 < heights.min() < 0.1
        assert 1.5 < heights.max() < 2.2
        assert consistent(recording)
