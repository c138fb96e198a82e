"""Binary FBX files are read correctly, or refused with the node or byte."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.errors import BadField, FormatNotSupported, Unreadable
from app.formats.fbx.reader import read_fbx
from app.formats.read import read_recording
from tests.formats.fbx.files import Bone, Curve, Take, fbx
from tests.formats.fbx.takes import (
    CHAIN,
    FRAMES,
    LEFT_HANDED,
    RIGHT_HANDED,
    SWAY,
    changed,
    clip,
    consistent,
    curves,
    expected,
)
from tests.formats.samples import bvh


def test_a_simple_file() -> None:
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
def test_all_widths_of_offsets_and_both_encodings(version: int, deflate: bool) -> None:
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
def test_all_parts_of_a_transform(trait: str, bone: int) -> None:
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
        bones = bones[:2]  # the scale of a sheared parent cannot be separated from its rotation
    recording = read_fbx(clip(bones))
    assert np.allclose(recording.positions, expected(bones), atol=1e-3)
    assert consistent(recording)


def test_shear_above_a_separately_inherited_scale_is_refused() -> None:
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


def test_missing_properties_come_from_the_template() -> None:
    bones_with_order = changed(
        1, {"RotationActive": 1, "RotationOrder": 5, "PreRotation": (1.0, 2.0, 3.0)}
    )
    bones = [
        *CHAIN[:1],
        replace(CHAIN[1], properties={**bones_with_order[1].properties}),
        *CHAIN[2:],
    ]
    template = {"RotationActive": 1, "RotationOrder": 5, "PreRotation": (1.0, 2.0, 3.0)}
    everywhere = [replace(b, properties={**b.properties, **template}) for b in bones]
    recording = read_fbx(clip(CHAIN, template=template))
    assert np.allclose(recording.positions, expected(everywhere), atol=1e-3)


@pytest.mark.parametrize("axes", RIGHT_HANDED + LEFT_HANDED)
def test_all_axes_become_x_right_y_up_z_front(axes: dict[str, int]) -> None:
    recording = read_fbx(clip(settings={"TimeMode": 6, **axes}))
    seen = expected(CHAIN)
    for column, name in enumerate(("CoordAxis", "UpAxis", "FrontAxis")):
        expected_column = axes[f"{name}Sign"] * seen[:, :, axes[name]]
        assert np.allclose(recording.positions[:, :, column], expected_column, atol=1e-4)
    assert consistent(recording)


def test_impossible_axes_are_refused() -> None:
    with pytest.raises(Unreadable, match="GlobalSettings"):
        read_fbx(clip(settings={"UpAxis": 0, "CoordAxis": 0}))


@pytest.mark.parametrize(
    ("factor", "meters"), [(1.0, 0.01), (100.0, 1.0), (2.54, 0.0254), (0.0, None)]
)
def test_units(factor: float, meters: float | None) -> None:
    recording = read_fbx(clip(settings={"TimeMode": 6, "UnitScaleFactor": factor}))
    assert recording.metres_per_unit == pytest.approx(meters)


@pytest.mark.parametrize(
    ("settings", "keys", "rate", "has_caution"),
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
def test_frame_rates(settings: dict[str, Any], keys: float, rate: float, has_caution: bool) -> None:
    recording = read_fbx(clip(rate=keys, settings=settings))
    assert recording.frame_rate == pytest.approx(rate, rel=1e-6)
    count = round((FRAMES - 1) * rate / keys) + 1
    assert len(recording.positions) == count
    step = (count - 1) // (FRAMES - 1)
    assert np.allclose(recording.positions[::step], expected(CHAIN), atol=1e-3)
    codes = [caution.code for caution in recording.cautions]
    assert codes == (["frame_rate_from_keys"] if has_caution else [])


def test_sparse_keys_are_sampled_at_the_rate_of_the_scene() -> None:
    turn = {(1, "Lcl Rotation"): {"Y": Curve([0, 0.7, 2.0], [0, 70, 200])}}
    recording = read_fbx(fbx(CHAIN, [Take("t", [turn])], settings={"TimeMode": 6}))
    assert len(recording.positions) == 61
    degrees = np.array([[0, 100 * i / 30, 0] for i in range(61)])
    assert np.allclose(
        recording.positions, expected(CHAIN, {(1, "Lcl Rotation"): degrees}), atol=1e-3
    )


def test_only_the_span_of_the_stack_is_read() -> None:
    take = Take("t", [curves(SWAY)], span=(1 / 30, 4 / 30))
    recording = read_fbx(fbx(CHAIN, [take], settings={"TimeMode": 6}))
    assert np.allclose(recording.positions, expected(CHAIN)[1:5], atol=1e-3)
    assert recording.start_frame == pytest.approx(1)


def test_axes_without_curves_keep_their_value() -> None:
    bones = changed(1, {"Lcl Rotation": (11.0, 22.0, 33.0)})
    only_y = {key: {"Y": found["Y"]} for key, found in curves(SWAY).items()}
    recording = read_fbx(fbx(bones, [Take("t", [only_y])], settings={"TimeMode": 6}))
    still = {key: values.copy() for key, values in SWAY.items()}
    still[0, "Lcl Translation"][:, [0, 2]] = [1, 2]
    still[0, "Lcl Rotation"][:, [0, 2]] = 0
    still[1, "Lcl Rotation"][:, [0, 2]] = [11, 33]
    assert np.allclose(recording.positions, expected(bones, still), atol=1e-3)


def test_the_longest_stack_is_read_by_default() -> None:
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


def test_a_stack_is_found_by_the_name_that_a_form_sends() -> None:
    name = "Ka\u0308mpfer|Schlag "
    content = fbx(CHAIN, [Take("a", [curves(SWAY)]), Take(name, [curves(SWAY)])])
    (caution,) = read_fbx(content, "K\u00e4mpfer|Schlag").cautions
    assert f"{name} was read" in caution.detail


def test_a_message_lists_a_limited_number_of_stacks() -> None:
    content = fbx(CHAIN, [Take(f"take{i}", [curves(SWAY)]) for i in range(103)])
    (caution,) = read_fbx(content).cautions
    assert "take99 and 3 more" in caution.detail


def test_a_stack_for_another_format_is_refused() -> None:
    assert len(read_recording(clip(), stack="walk").positions) == FRAMES
    with pytest.raises(BadField, match="not with BVH"):
        read_recording(bvh(), stack="walk")
