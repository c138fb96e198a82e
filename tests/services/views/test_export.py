"""Ready clips exported as files: a reader gets the same movement from them."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from app.demo import DemoClip
from app.errors import BadField, ClipNotFound, ClipNotReady
from app.formats.bvh.reader import read_bvh
from app.formats.c3d.points import read_points
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.canonical.units import METERS_PER_UNIT
from app.motion.canonical.up_axis import to_y_up
from app.motion.motion import Motion
from app.motion.posing.canonical_body import BODY_ROLES
from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.views import export, views
from app.services.views.export_format import ExportFormat, ExportUnit
from app.services.views.low_dimensional import Reduction
from app.store.clips.record import ClipRecord, ClipState
from tests.formats.gltf.files import Glb
from tests.formats.npz.files import npz
from tests.formats.trc.files import opensim
from tests.libraries import FindClip, upload, work
from tests.people import CONVENTIONS, person

TENTH_OF_MM = 1e-4


def exported(lib: Library, clip: ClipRecord, format: str, **options: object) -> bytes:
    return b"".join(export.export(lib, clip.id, format, **options).blocks)  # type: ignore[arg-type]


def positions_of(content: bytes, format: str) -> tuple[tuple[str, ...], FloatArray]:
    """Joint names and (frames, joints, 3) meters of an exported file."""
    if format == "glb":
        glb = Glb(content)
        joints = glb.document["skins"][0]["joints"]
        names = tuple(glb.document["nodes"][joint]["name"] for joint in joints)
        return names, glb.world()[:, joints][..., :3, 3]
    if format == "csv":
        head, *rows = csv.reader(io.StringIO(content.decode()))
        numbers = np.array(rows, dtype=float)[:, 1:]
        names = tuple(name.removesuffix("_x_m") for name in head[1::3])
        return names, numbers.reshape(len(rows), -1, 3)
    if format == "trc":
        _, labels, _, positions = opensim(content)
        return tuple(labels), positions / 1000
    if format == "c3d":
        points = read_points(content)
        return points.labels, to_y_up(points.positions, "z") / 1000
    recording = read_recording(content)
    scale = 0.01 if format == "bvh" else 1.0
    return recording.skeleton.names, recording.positions * scale


def assert_same_places(content: bytes, format: str, motion: Motion, within: float) -> None:
    names, positions = positions_of(content, format)
    assert sorted(names) == sorted(motion.names)
    order = [motion.names.index(name) for name in names]
    assert np.abs(positions - motion.positions[:, order]).max() < within


@pytest.mark.parametrize("format", ExportFormat)
@pytest.mark.parametrize("task", ["walk", "kick"])
def test_exported_positions_are_within_a_tenth_of_a_millimeter(
    ready_library: Library, clip_of: FindClip, format: ExportFormat, task: str
) -> None:
    clip = clip_of("ada", task)
    content = exported(ready_library, clip, format)
    assert content == exported(ready_library, clip, format)
    assert_same_places(content, format, load_motion(ready_library, clip), TENTH_OF_MM)


@pytest.mark.parametrize("unit", ExportUnit)
@pytest.mark.parametrize("format", ["bvh", "csv", "c3d", "trc"])
def test_lengths_have_the_unit_that_is_asked_for(
    ready_library: Library, clip_of: FindClip, format: str, unit: ExportUnit
) -> None:
    clip = clip_of("ada", "walk")
    content = exported(ready_library, clip, format, unit=unit)
    meters = METERS_PER_UNIT[unit]
    if format == "bvh":
        positions = read_bvh(content).positions * meters
        names = read_bvh(content).skeleton.names
    elif format == "csv":
        head, *rows = csv.reader(io.StringIO(content.decode()))
        names = tuple(name.removesuffix(f"_x_{unit}") for name in head[1::3])
        positions = meters * np.array(rows, dtype=float)[:, 1:].reshape(len(rows), -1, 3)
    elif format == "trc":
        meta, labels, _, found = opensim(content)
        assert meta["Units"] == unit
        names, positions = tuple(labels), found * meters
    else:
        points = read_points(content)
        names, positions = points.labels, to_y_up(points.positions, "z") * meters
    seen = load_motion(ready_library, clip)
    order = [seen.names.index(name) for name in names]
    assert np.abs(positions - seen.positions[:, order]).max() < TENTH_OF_MM


@pytest.mark.parametrize("format", ["npz", "csv", "c3d", "trc"])
def test_joints_may_be_called_by_their_roles(
    ready_library: Library, clip_of: FindClip, format: str
) -> None:
    clip = clip_of("ada", "walk")
    motion = load_motion(ready_library, clip)
    names, positions = positions_of(exported(ready_library, clip, format, joints="roles"), format)
    assert set(names) == {role.value for role in motion.roles}
    columns = [motion.roles[JointRole(name)] for name in names]
    assert np.abs(positions - motion.positions[:, columns]).max() < TENTH_OF_MM
    if format == "npz":
        again = read_recording(exported(ready_library, clip, format, joints="roles"))
        assert np.count_nonzero(again.skeleton.parents < 0) == 1


def test_a_bvh_that_is_imported_again_is_the_same_motion(
    ready_library: Library, clip_of: FindClip
) -> None:
    before = load_motion(ready_library, clip_of("bruno", "kick"))
    for format in ("bvh", "npz"):
        content = exported(ready_library, clip_of("bruno", "kick"), format)
        after = canonicalize(read_recording(content))
        assert after.roles == before.roles
        assert after.frame_rate == pytest.approx(before.frame_rate, rel=1e-4)
        assert np.abs(after.positions - before.positions).max() < TENTH_OF_MM


def test_exported_rotations_are_those_of_the_file(
    ready_library: Library, clip_of: FindClip, some_demo_clips: list[DemoClip]
) -> None:
    clip = clip_of("ada", "wave")
    (original,) = [c for c in some_demo_clips if (c.person, c.task) == ("ada", "wave")]
    before = read_bvh(original.content)
    after = read_bvh(exported(ready_library, clip, "bvh"))
    assert after.skeleton.names == before.skeleton.names
    assert after.translations is None
    assert before.rotations is not None
    assert after.rotations is not None
    same = np.abs(np.sum(before.rotations * after.rotations, axis=-1))
    assert same.min() > 1 - 1e-6
    assert len(after.skeleton.end_parents) == len(before.skeleton.end_parents)


@pytest.mark.parametrize("format", ExportFormat)
def test_the_movement_is_the_same_at_any_frame_rate(
    ready_library: Library, clip_of: FindClip, format: ExportFormat
) -> None:
    clip = clip_of("chika", "bow")
    names, positions = positions_of(exported(ready_library, clip, format, fps=24.0), format)
    seen = views.motion(ready_library, clip.id, fps=24.0)
    order = [seen.joint_names.index(name) for name in names]
    assert np.abs(positions - seen.positions[:, order]).max() < 0.01


@pytest.mark.parametrize("format", ExportFormat)
def test_clips_of_two_sources_play_on_one_body(
    ready_library: Library, clip_of: FindClip, format: ExportFormat
) -> None:
    bones = []
    for actor in ("ada", "bruno"):
        content = exported(ready_library, clip_of(actor, "walk"), format, skeleton="canonical")
        names, positions = positions_of(content, format)
        assert set(names) == {role.value for role in BODY_ROLES}
        order = [names.index(role.value) for role in BODY_ROLES]
        bones.append(np.linalg.norm(np.diff(positions[:, order[-4:]], axis=1), axis=-1))
    np.testing.assert_allclose(bones[0].mean(axis=0), bones[1].mean(axis=0), atol=TENTH_OF_MM)
    np.testing.assert_allclose(bones[0].std(axis=0), 0, atol=TENTH_OF_MM)


def test_positions_without_rotations_are_solved(lib: Library) -> None:
    recording = person(CONVENTIONS["SMPL"], frames=60)
    content = npz(
        positions=recording.positions,
        joint_names=np.array(recording.skeleton.names),
        parents=recording.skeleton.parents,
        frame_rate=60.0,
    )
    clip = clips.create_clip(lib, io.BytesIO(content), "=a/../<b>?.npz").clip
    work(lib.settings)
    clip = clips.get_clip(lib, clip.id)
    assert clip.state is ClipState.READY
    for format in ExportFormat:
        positions = exported(lib, clip, format)
        assert_same_places(positions, format, load_motion(lib, clip), TENTH_OF_MM)


def test_if_the_file_now_gives_other_positions_the_stored_ones_are_exported(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    clip = upload(lib, some_demo_clips[0]).clip
    work(lib.settings)
    clip = clips.get_clip(lib, clip.id)
    Path(clips.open_file(lib, clip.id).path).write_bytes(b"HIERARCHY\nno longer")
    positions = exported(lib, clip, "bvh")
    assert_same_places(positions, "bvh", load_motion(lib, clip), TENTH_OF_MM)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("walk 1", "walk 1.bvh"), ('../a"b\\c', "a_b_c.bvh"), ("日本", "日本.bvh"), ("...", None)],
)
def test_file_names_are_safe(
    ready_library: Library, clip_of: FindClip, name: str, expected: str | None
) -> None:
    clip = clip_of("chika", "wave")
    before = clips.update_clip(ready_library, clip.id, {"name": name})
    try:
        file_name = export.export(ready_library, clip.id, "bvh").file_name
    finally:
        clips.update_clip(ready_library, clip.id, {"name": clip.name})
    assert before.name == name
    assert file_name == (expected or f"{clip.id}.bvh")


@pytest.mark.parametrize(
    ("options", "location"),
    [
        ({"format": "fbx"}, "format"),
        ({"format": "bvh", "skeleton": "mine"}, "skeleton"),
        ({"format": "csv", "fps": 0.0}, "fps"),
        ({"format": "csv", "fps": float("nan")}, "fps"),
        ({"format": "glb", "fps": 1001.0}, "fps"),
        ({"format": "csv", "content": "forces"}, "content"),
        ({"format": "bvh", "content": "positions"}, "content"),
        ({"format": "bvh", "unit": "parsec"}, "unit"),
        ({"format": "glb", "unit": "mm"}, "unit"),
        ({"format": "npz", "unit": "cm"}, "unit"),
        ({"format": "csv", "content": "gait", "unit": "cm"}, "unit"),
        ({"format": "bvh", "joints": "roles"}, "joints"),
        ({"format": "csv", "joints": "some"}, "joints"),
        ({"format": "csv", "content": "angles", "joints": "roles"}, "joints"),
        ({"format": "csv", "content": "angles", "skeleton": "canonical"}, "skeleton"),
        ({"format": "csv", "content": "angles", "reduction": Reduction(3)}, "dimensions"),
        ({"format": "csv", "content": "cycles", "fps": 30.0}, "fps"),
    ],
)
def test_a_wrong_field_is_named(
    ready_library: Library, clip_of: FindClip, options: dict[str, object], location: str
) -> None:
    with pytest.raises(BadField) as refused:
        export.export(ready_library, clip_of("ada", "walk").id, **options)  # type: ignore[arg-type]
    assert refused.value.places[0].location == location


def test_only_ready_clips_are_exported(lib: Library) -> None:
    queued = clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), "a.bvh").clip
    with pytest.raises(ClipNotReady):
        export.export(lib, queued.id, "bvh")
    with pytest.raises(ClipNotFound):
        export.export(lib, "clip_none", "bvh")
