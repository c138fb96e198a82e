"""Binary FBX as it is found in the wild: read rightly, or refused by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import BadField, FormatNotSupported, TooLarge, Unreadable
from app.formats.fbx import read_fbx
from app.formats.read import read_recording
from app.motion.canonical import canonicalise
from app.motion.joint_roles import SUN_ROLES
from app.motion.kinematics import forward_kinematics, local_translations
from app.motion.recording import Recording
from app.numerics.arrays import FloatArray
from tests.formats.fbx_files import (
    CONSTANT,
    LINEAR,
    NEXT,
    Bone,
    Curve,
    Curves,
    Record,
    Take,
    fbx,
)
from tests.formats.fbx_twin import world_positions
from tests.people import BODY, CONVENTIONS, ROLES
from tests.real_clips import real_clips

Animated = Mapping[tuple[int, str], FloatArray]
CHAIN = [
    Bone("Hips", -1, {"Lcl Translation": (1.0, 90.0, 2.0)}),
    Bone("Spine", 0, {"Lcl Translation": (0.0, 20.0, 3.0)}),
    Bone("Head", 1, {"Lcl Translation": (1.0, 15.0, 0.0)}),
]
FRAMES = 6
SWAY: dict[tuple[int, str], FloatArray] = {
    (0, "Lcl Translation"): np.linspace([1, 90, 2], [30, 80, -5], FRAMES),
    (0, "Lcl Rotation"): np.linspace([0, 0, 0], [10, 70, -40], FRAMES),
    (1, "Lcl Rotation"): np.linspace([5, -20, 0], [60, 30, 100], FRAMES),
}


def curves(animated: Animated, rate: float = 30.0) -> Curves:
    """Linear keys at each frame."""
    return {
        key: {
            axis: Curve([i / rate for i in range(len(values))], values[:, column].tolist())
            for column, axis in enumerate("XYZ")
        }
        for key, values in animated.items()
    }


def clip(
    bones: Sequence[Bone] = CHAIN, animated: Animated = SWAY, rate: float = 30.0, **traits: Any
) -> bytes:
    traits.setdefault("settings", {"TimeMode": 6, "UnitScaleFactor": 1.0})
    return fbx(bones, [Take("walk", [curves(animated, rate)])], **traits)


def expected(bones: Sequence[Bone], animated: Animated = SWAY) -> FloatArray:
    """(frames, bones, 3) by the slow twin."""
    frames = max(len(values) for values in animated.values())
    return np.array(
        [
            world_positions(bones, {key: values[i] for key, values in animated.items()})
            for i in range(frames)
        ]
    )


def consistent(recording: Recording) -> bool:
    """Whether rotations, translations and offsets tell the same as the positions."""
    assert recording.rotations is not None
    moved = recording.translations
    if moved is None:
        moved = local_translations(recording.skeleton, recording.positions[:, 0])
    solved = forward_kinematics(recording.skeleton, recording.rotations, moved)
    return bool(np.allclose(solved, recording.positions, atol=2e-3))


def changed(bone: int, properties: Mapping[str, Any]) -> list[Bone]:
    bones = list(CHAIN)
    bones[bone] = replace(bones[bone], properties={**bones[bone].properties, **properties})
    return bones


def turning(curve: Curve) -> Take:
    """A stack in which one curve turns the hips."""
    return Take("t", [{(0, "Lcl Rotation"): {"X": curve}}])


WALK = Take("walk", [curves(SWAY)])


def test_a_plain_file() -> None:
    recording = read_recording(clip())
    assert recording.format == "fbx"
    assert recording.skeleton.names == ("Hips", "Spine", "Head")
    assert recording.skeleton.parents.tolist() == [-1, 0, 1]
    assert recording.frame_rate == 30
    assert recording.metres_per_unit == 0.01
    assert recording.up_axis == "y"
    assert recording.translations is None
    assert recording.cautions == ()
    assert recording.positions.dtype == np.float32
    assert np.allclose(recording.positions, expected(CHAIN), atol=1e-4)
    assert consistent(recording)


@pytest.mark.parametrize("version", [7100, 7400, 7500, 7700])
@pytest.mark.parametrize("deflate", [False, True])
def test_every_width_of_offsets_and_both_encodings(version: int, deflate: bool) -> None:
    recording = read_fbx(clip(version=version, deflate=deflate))
    assert np.allclose(recording.positions, expected(CHAIN), atol=1e-4)


ACTIVE = {"RotationActive": 1}
TRAITS: dict[str, dict[str, Any]] = {
    "pre-rotation": {**ACTIVE, "PreRotation": (20.0, -50.0, 70.0)},
    "post-rotation": {**ACTIVE, "PostRotation": (-30.0, 40.0, 110.0)},
    "both": {**ACTIVE, "PreRotation": (20.0, 30.0, 0.0), "PostRotation": (0.0, 40.0, 10.0)},
    "inactive": {"PreRotation": (20.0, 30.0, 0.0), "RotationOrder": 3},
    "rotation pivot": {"RotationPivot": (1.0, 5.0, -2.0)},
    "rotation offset": {"RotationOffset": (3.0, -1.0, 2.0)},
    "scaling pivot": {"ScalingPivot": (1.0, 2.0, 3.0), "Lcl Scaling": (2.0, 2.0, 2.0)},
    "scaling offset": {"ScalingOffset": (1.0, 2.0, 3.0)},
    "everything": {
        **ACTIVE, "RotationOrder": 4, "InheritType": 1,
        "PreRotation": (20.0, 30.0, 0.0), "PostRotation": (0.0, 40.0, 9.0),
        "RotationPivot": (1.0, 5.0, -2.0), "RotationOffset": (3.0, -1.0, 2.0),
        "ScalingPivot": (1.0, 2.0, 3.0), "ScalingOffset": (4.0, 2.0, 1.0),
        "Lcl Scaling": (2.0, 0.5, 1.5),
    },
}  # fmt: skip
TRAITS |= {f"order {n}": {**ACTIVE, "RotationOrder": n} for n in range(6)}


@pytest.mark.parametrize("bone", [0, 1])
@pytest.mark.parametrize("trait", TRAITS)
def test_the_whole_chain_of_a_node(trait: str, bone: int) -> None:
    bones = [replace(b, properties={**b.properties, "InheritType": 1}) for b in CHAIN]
    bones[bone] = replace(bones[bone], properties={**bones[bone].properties, **TRAITS[trait]})
    recording = read_fbx(clip(bones))
    assert np.allclose(recording.positions, expected(bones), atol=1e-3)
    assert consistent(recording)


@pytest.mark.parametrize("inherits", [0, 1, 2])
@pytest.mark.parametrize("scale", [(2.0, 2.0, 2.0), (2.0, 0.5, 1.0), (-1.0, 1.0, 1.0)])
def test_inherit_types(inherits: int, scale: tuple[float, float, float]) -> None:
    bones = [
        Bone("Hips", -1, {"Lcl Translation": (0.0, 90.0, 0.0), "Lcl Scaling": scale}),
        Bone("Spine", 0, {"Lcl Translation": (0.0, 20.0, 3.0), "InheritType": inherits}),
        Bone("Head", 1, {"Lcl Translation": (1.0, 15.0, 0.0), "Lcl Scaling": (3.0, 3.0, 3.0)}),
        Bone("Nose", 2, {"Lcl Translation": (0.0, 0.0, 9.0), "InheritType": 2}),
    ]
    if inherits == 1 and scale != (2.0, 2.0, 2.0):
        bones = bones[:2]  # a sheared parent's scale cannot be taken apart
    recording = read_fbx(clip(bones))
    assert np.allclose(recording.positions, expected(bones), atol=1e-3)
    assert consistent(recording)


def test_shear_above_a_scale_that_is_inherited_apart_is_refused() -> None:
    bones = changed(0, {"Lcl Scaling": (3.0, 1.0, 1.0)})
    bones[1] = replace(bones[1], properties={**bones[1].properties, "InheritType": 1})
    with pytest.raises(FormatNotSupported, match="Model 102"):
        read_fbx(clip(bones))


def test_scales_over_time() -> None:
    animated = {**SWAY, (0, "Lcl Scaling"): np.linspace([1, 1, 1], [2, 2, 2], FRAMES)}
    recording = read_fbx(clip(CHAIN, animated))
    assert np.allclose(recording.positions, expected(CHAIN, animated), atol=1e-3)
    assert recording.translations is not None
    assert consistent(recording)


def test_bones_that_stretch() -> None:
    animated = {**SWAY, (2, "Lcl Translation"): np.linspace([1, 15, 0], [3, 25, 0], FRAMES)}
    recording = read_fbx(clip(CHAIN, animated))
    assert np.allclose(recording.positions, expected(CHAIN, animated), atol=1e-3)
    assert recording.translations is not None
    assert consistent(recording)


def test_properties_that_a_node_lacks_come_from_the_template() -> None:
    said = changed(1, {"RotationActive": 1, "RotationOrder": 5, "PreRotation": (1.0, 2.0, 3.0)})
    bones = [*CHAIN[:1], replace(CHAIN[1], properties={**said[1].properties}), *CHAIN[2:]]
    template = {"RotationActive": 1, "RotationOrder": 5, "PreRotation": (1.0, 2.0, 3.0)}
    everywhere = [replace(b, properties={**b.properties, **template}) for b in bones]
    recording = read_fbx(clip(CHAIN, template=template))
    assert np.allclose(recording.positions, expected(everywhere), atol=1e-3)


def axis_system(coord: str, up: str, front: str) -> dict[str, int]:
    """GlobalSettings of axes such as "-z"."""
    found = {}
    for name, axis in (("CoordAxis", coord), ("UpAxis", up), ("FrontAxis", front)):
        found[name] = "xyz".index(axis[-1])
        found[f"{name}Sign"] = -1 if axis.startswith("-") else 1
    return found


RIGHT_HANDED = [
    axis_system("x", "y", "z"),
    axis_system("x", "z", "-y"),
    axis_system("z", "x", "y"),
    axis_system("x", "-y", "-z"),
]
LEFT_HANDED = [axis_system("x", "y", "-z"), axis_system("x", "z", "y")]


@pytest.mark.parametrize("axes", RIGHT_HANDED + LEFT_HANDED)
def test_any_axes_come_out_as_x_right_y_up_z_front(axes: dict[str, int]) -> None:
    recording = read_fbx(clip(settings={"TimeMode": 6, **axes}))
    seen = expected(CHAIN)
    for column, name in enumerate(("CoordAxis", "UpAxis", "FrontAxis")):
        told = axes[f"{name}Sign"] * seen[:, :, axes[name]]
        assert np.allclose(recording.positions[:, :, column], told, atol=1e-4)
    assert consistent(recording)


def test_axes_that_are_none_are_refused() -> None:
    with pytest.raises(Unreadable, match="GlobalSettings"):
        read_fbx(clip(settings={"UpAxis": 0, "CoordAxis": 0}))


@pytest.mark.parametrize(
    ("factor", "metres"), [(1.0, 0.01), (100.0, 1.0), (2.54, 0.0254), (0.0, None)]
)
def test_units(factor: float, metres: float | None) -> None:
    recording = read_fbx(clip(settings={"TimeMode": 6, "UnitScaleFactor": factor}))
    assert recording.metres_per_unit == pytest.approx(metres)


@pytest.mark.parametrize(
    ("said", "keys", "rate", "doubted"),
    [
        ({"TimeMode": 6}, 30, 30, False),
        ({"TimeMode": 3}, 60, 60, False),
        ({"TimeMode": 11}, 24, 24, False),
        ({"TimeMode": 13}, 24000 / 1001, 24000 / 1001, False),
        ({"TimeMode": 14, "CustomFrameRate": 33.0}, 33, 33, False),
        ({"TimeMode": 6}, 120, 120, True),
        ({"TimeMode": 12}, 30, 30, True),
        ({"TimeMode": 0}, 50, 50, False),
        ({}, 25, 25, False),
        ({"TimeMode": 1}, 30, 120, False),
    ],
)
def test_frame_rates(said: dict[str, Any], keys: float, rate: float, doubted: bool) -> None:
    recording = read_fbx(clip(rate=keys, settings=said))
    assert recording.frame_rate == pytest.approx(rate, rel=1e-6)
    count = round((FRAMES - 1) * rate / keys) + 1
    assert len(recording.positions) == count
    step = (count - 1) // (FRAMES - 1)
    assert np.allclose(recording.positions[::step], expected(CHAIN), atol=1e-3)
    codes = [caution.code for caution in recording.cautions]
    assert codes == (["frame_rate_from_keys"] if doubted else [])


def test_sparse_keys_are_sampled_at_the_scenes_rate() -> None:
    turn = {(1, "Lcl Rotation"): {"Y": Curve([0, 0.7, 2.0], [0, 70, 200])}}
    recording = read_fbx(fbx(CHAIN, [Take("t", [turn])], settings={"TimeMode": 6}))
    assert len(recording.positions) == 61
    degrees = np.array([[0, 100 * i / 30, 0] for i in range(61)])
    assert np.allclose(
        recording.positions, expected(CHAIN, {(1, "Lcl Rotation"): degrees}), atol=1e-3
    )


def test_only_the_stacks_span_is_read() -> None:
    take = Take("t", [curves(SWAY)], span=(1 / 30, 4 / 30))
    recording = read_fbx(fbx(CHAIN, [take], settings={"TimeMode": 6}))
    assert np.allclose(recording.positions, expected(CHAIN)[1:5], atol=1e-3)


def test_axes_without_curves_keep_their_value() -> None:
    bones = changed(1, {"Lcl Rotation": (11.0, 22.0, 33.0)})
    only_y = {key: {"Y": found["Y"]} for key, found in curves(SWAY).items()}
    recording = read_fbx(fbx(bones, [Take("t", [only_y])], settings={"TimeMode": 6}))
    still = {key: values.copy() for key, values in SWAY.items()}
    still[0, "Lcl Translation"][:, [0, 2]] = [1, 2]
    still[0, "Lcl Rotation"][:, [0, 2]] = 0
    still[1, "Lcl Rotation"][:, [0, 2]] = [11, 33]
    assert np.allclose(recording.positions, expected(bones, still), atol=1e-3)


def test_the_longest_stack_is_read_and_another_when_it_is_asked_for() -> None:
    short = {key: values[:3] + 1 for key, values in SWAY.items()}
    content = fbx(
        CHAIN,
        [Take("short", [curves(short)]), Take("long", [curves(SWAY)]), Take("empty", [{}])],
        settings={"TimeMode": 6},
    )
    recording = read_fbx(content)
    assert np.allclose(recording.positions, expected(CHAIN), atol=1e-3)
    (caution,) = recording.cautions
    assert caution.code == "stack_chosen"
    assert "short, long" in caution.detail
    assert "long was read" in caution.detail
    assert np.allclose(read_fbx(content, "short").positions, expected(CHAIN, short), atol=1e-3)
    with pytest.raises(BadField, match="short, long"):
        read_fbx(content, "walk")
    with pytest.raises(Unreadable, match="AnimationStack"):
        read_fbx(content, "empty")


def test_nodes_above_the_body_carry_it() -> None:
    armature = {"Lcl Rotation": (-90.0, 0.0, 0.0), "Lcl Scaling": (100.0, 100.0, 100.0)}
    bones = [Bone("Scene", -1, armature, "Null")]
    bones += [replace(bone, parent=bone.parent + 1) for bone in CHAIN]
    animated = {(bone + 1, name): values for (bone, name), values in SWAY.items()}
    recording = read_fbx(clip(bones, animated))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")
    assert np.allclose(recording.positions, expected(bones, animated)[:, 1:], rtol=1e-5, atol=1e-2)


def test_a_null_that_carries_the_body_is_a_joint_where_it_moves() -> None:
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


def test_of_several_skeletons_the_one_that_moves_most_is_read() -> None:
    bones = [Bone("Prop"), Bone("Tip", 0), Bone("Handle", 1), Bone("Grip", 2)]
    bones += [replace(b, parent=b.parent + 4 if b.parent >= 0 else -1) for b in CHAIN]
    animated = {(bone + 4, name): values for (bone, name), values in SWAY.items()}
    animated[0, "Lcl Rotation"] = np.linspace([0, 0, 0], [1, 2, 3], FRAMES)
    recording = read_fbx(clip(bones, animated))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")
    assert [caution.code for caution in recording.cautions] == ["skeleton_chosen"]


def test_meshes_beside_the_body_do_not_matter() -> None:
    bones = [*CHAIN, Bone("Shirt", -1, {}, "Mesh"), Bone("Camera", 2, {}, "Camera")]
    recording = read_fbx(clip(bones))
    assert recording.skeleton.names == ("Hips", "Spine", "Head")


@pytest.mark.parametrize(
    ("bones", "take", "place"),
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
def test_what_cannot_be_read_is_named(bones: list[Bone], take: list[Take], place: str) -> None:
    with pytest.raises(Unreadable) as caught:
        read_fbx(fbx(bones, take))
    (found,) = caught.value.places
    assert found.location.startswith("node Objects/")
    assert place in found.location
    assert "expected" in found.message


REPEATED = {
    "X": Curve(
        [0, 0.1],
        [0, 9],
        extra=(Record("Post-Extrapolation", [], [Record("Type", [b"R"])]),),
    )
}


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"; FBX 7.4.0 project file\n", "text"),
        (clip(version=6100), "6.1"),
        (clip(version=8000), "8.0"),
        (clip(header=[Record("OtherFlags", [], [Record("TCDefinition", [0])])]), "OtherFlags"),
        (clip().replace(b"EncryptionTypeI\0", b"EncryptionTypeI\1"), "encrypted"),
        (clip(changed(1, {"RotationActive": 1, "RotationOrder": 6})), "order"),
        (clip(changed(1, {"InheritType": 3})), "inherit"),
        (clip(CHAIN, {**SWAY, (1, "PreRotation"): SWAY[1, "Lcl Rotation"]}), "PreRotation"),
        (fbx(CHAIN, [Take("t", [curves(SWAY), curves(SWAY)])]), "layer"),
        (fbx(CHAIN, [Take("t", [{**curves(SWAY), (2, "Lcl Rotation"): REPEATED}])]), "Extrapola"),
    ],
)
def test_what_we_do_not_know_is_refused_by_name(content: bytes, word: str) -> None:
    with pytest.raises(FormatNotSupported, match=word):
        read_fbx(content)


def test_layers_without_edits_and_muted_ones_do_not_matter() -> None:
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


def test_a_stray_key_far_away_does_not_eat_memory() -> None:
    far = {(1, "Lcl Rotation"): {"Z": Curve([0, 1e8], [10, 50])}}
    with pytest.raises(TooLarge):
        read_fbx(fbx(CHAIN, [Take("t", [far])], settings={"TimeMode": 6}))


def person_bones(names: Mapping[Any, str]) -> list[Bone]:
    return [
        Bone(names[role], -1 if above is None else ROLES.index(above),
             {"Lcl Translation": tuple(100.0 * np.array(offset))})
        for role, above, offset in BODY
    ]  # fmt: skip


@pytest.mark.parametrize("convention", ["MotionBuilder", "Mixamo", "Unreal", "3ds Max"])
@pytest.mark.parametrize("axes", [*RIGHT_HANDED[:2], LEFT_HANDED[0]])
def test_a_person_becomes_a_canonical_motion(convention: str, axes: dict[str, int]) -> None:
    bones = person_bones(CONVENTIONS[convention])
    # the person stands along Y; a node above turns it to the file's own axes
    turn = np.zeros((3, 3))
    for row, name in enumerate(("CoordAxis", "UpAxis", "FrontAxis")):
        turn[row, axes[name]] = axes[f"{name}Sign"]
    bones = [
        replace(b, properties={"Lcl Translation": tuple(turn.T @ b.properties["Lcl Translation"])})
        for b in bones
    ]
    animated = {(1, "Lcl Rotation"): np.linspace([0, 0, 0], [3, 2, 1], 40)}
    motion = canonicalise(read_fbx(clip(bones, animated, settings={"TimeMode": 6, **axes})))
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
def test_what_is_written_is_read(bones: list[Bone], seed: int, wide: bool) -> None:
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
        motion = canonicalise(recording)
        assert motion.missing_roles == ()
        assert motion.frame_rate == 30
        assert motion.metres_per_unit == 0.01
        heights = motion.positions[..., 1]
        assert -0.1 < heights.min() < 0.1
        assert 1.5 < heights.max() < 2.2
        assert consistent(recording)
