"""Clips reduced to few dimensions: their motion, pictures and files."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

from app.errors import BadField, ClipNotFound, NotEnoughKeyposes
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.posing.canonical_body import BODY_ROLES
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray
from app.services.library.library import Library
from app.services.views import keyposes as services_keyposes
from app.services.views import low_dimensional, views
from app.services.views.animations import animation_svg
from app.services.views.export import export
from app.services.views.low_dimensional import Reduction, view
from tests.libraries import FindClip
from tests.services.views.test_export import positions_of


def _rms(one: FloatArray, other: FloatArray) -> float:
    away = np.linalg.norm(one.astype(float) - other, axis=-1)
    return float(np.sqrt(np.mean(away**2)))


@pytest.mark.parametrize("basis", ["keypose", "uniform"])
def test_the_reported_error_is_the_distance_to_the_original(
    ready_library: Library, clip_of: FindClip, basis: str
) -> None:
    clip = clip_of("ada", "wave")
    original = views.motion(ready_library, clip.id, 30.0, "roles").positions
    for dimensions in (1, 4):
        found = view(ready_library, clip.id, Reduction(dimensions, basis))
        assert found.motion.frame_rate == 30.0
        assert found.motion.joint_names == tuple(SUN_ROLES)
        assert found.motion.positions.dtype == np.float32
        reported = found.reduced.errors[dimensions - 1]
        assert reported == pytest.approx(_rms(found.motion.positions, original), abs=2e-4)
        assert found.eigen_motion.shape == (len(original), 3)
    assert found.reduced.model.poses == len(found.reduced.poses) == len(found.reduced.errors)


def test_both_bases_have_the_same_number_of_poses(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("bruno", "wave")
    keyposes = services_keyposes.view(ready_library, clip.id).found.frames / 30.0
    by_keyposes = view(ready_library, clip.id, Reduction(2)).reduced
    uniform = view(ready_library, clip.id, Reduction(2, "uniform")).reduced
    assert [pose.time for pose in by_keyposes.poses] == pytest.approx(list(keyposes))
    assert uniform.model.poses == by_keyposes.model.poses == len(keyposes)
    steps = np.diff([pose.time for pose in uniform.poses])
    assert np.ptp(steps) <= 1 / 30 + 1e-9
    assert {pose.clip_id for pose in uniform.poses} == {clip.id}


def test_clips_of_several_persons_make_one_model(ready_library: Library, clip_of: FindClip) -> None:
    clips = [clip_of(person, "wave") for person in ("ada", "bruno", "chika")]
    ids = [clip.id for clip in clips]
    alone = [view(ready_library, i, Reduction(2)).reduced for i in ids]
    joint = view(ready_library, ids[0], Reduction(2, model_clips=[*ids, ids[1]])).reduced
    assert joint.model.poses == sum(one.model.poses for one in alone)
    assert list(dict.fromkeys(pose.clip_id for pose in joint.poses)) == ids
    others = view(ready_library, ids[0], Reduction(3, model_clips=ids[1:])).reduced
    assert ids[0] not in {pose.clip_id for pose in others.poses}
    assert others.errors[2] > view(ready_library, ids[0], Reduction(3)).reduced.errors[2]


def test_a_clip_without_keyposes_can_have_uniform_poses(
    ready_library: Library, clip_of: FindClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    bow, wave = clip_of("ada", "bow"), clip_of("ada", "wave")
    held = {bow.id: [7], wave.id: [3, 20, 44]}
    monkeypatch.setattr(
        low_dimensional, "keypose_frames", lambda lib, clip_id, track: np.array(held[clip_id], int)
    )
    for basis in ("keypose", "uniform"):
        with pytest.raises(NotEnoughKeyposes, match="found 1") as caught:
            view(ready_library, bow.id, Reduction(1, basis))
        assert [place.message for place in caught.value.places] == [f"{bow.id}: keyposes: 1"]
    found = view(ready_library, bow.id, Reduction(2, "uniform", poses=12)).reduced
    assert found.model.poses == 12
    assert found.variance_kept[1] > 0.9
    other = view(ready_library, bow.id, Reduction(1, model_clips=[wave.id])).reduced
    assert other.model.poses == 3
    held[bow.id] = []
    both = view(ready_library, wave.id, Reduction(1, model_clips=[bow.id, wave.id])).reduced
    assert [pose.clip_id for pose in both.poses] == [wave.id] * 3


def test_by_default_there_are_three_dimensions_or_fewer(
    ready_library: Library, clip_of: FindClip
) -> None:
    assert view(ready_library, clip_of("ada", "wave").id, Reduction()).reduced.dimensions == 3
    few = view(ready_library, clip_of("ada", "bow").id, Reduction(basis="uniform", poses=2))
    assert few.reduced.dimensions == 2


@pytest.mark.parametrize(
    ("reduction", "field", "message"),
    [
        (Reduction(0), "dimensions", "at least 1"),
        (Reduction(99), "dimensions", "from 1 to "),
        (Reduction(2, "cubist"), "basis", "keypose, uniform"),
        (Reduction(2, poses=3), "poses", "basis=uniform"),
        (Reduction(2, "uniform", poses=0), "poses", "from 1 to 1000"),
        (Reduction(2, model_clips=["x"] * 51), "model_clips", "at most 50"),
    ],
)
def test_an_impossible_reduction_is_refused_by_field(
    ready_library: Library, clip_of: FindClip, reduction: Reduction, field: str, message: str
) -> None:
    clip = clip_of("ada", "wave")
    with pytest.raises(BadField, match=message) as caught:
        view(ready_library, clip.id, reduction)
    assert [place.location for place in caught.value.places] == [field]


def test_too_many_dimensions_are_refused_with_the_number_of_poses(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "wave")
    count = view(ready_library, clip.id, Reduction(1)).reduced.model.poses
    with pytest.raises(BadField, match=f"from 1 to {count}, the poses of the model"):
        view(ready_library, clip.id, Reduction(count + 1))
    assert view(ready_library, clip.id, Reduction(count)).reduced.dimensions == count


@pytest.mark.parametrize("fps", [0.0, float("nan"), 1e6])
def test_other_frame_rates_are_refused(
    ready_library: Library, clip_of: FindClip, fps: float
) -> None:
    with pytest.raises(BadField, match="fps"):
        view(ready_library, clip_of("ada", "wave").id, Reduction(), fps)


def test_model_clips_must_exist(ready_library: Library, clip_of: FindClip) -> None:
    with pytest.raises(ClipNotFound):
        view(ready_library, clip_of("ada", "wave").id, Reduction(model_clips=["clip_none"]))


def test_a_reduced_motion_is_resampled_by_time(ready_library: Library, clip_of: FindClip) -> None:
    clip = clip_of("ada", "wave")
    slow = view(ready_library, clip.id, Reduction(), 10.0)
    usual = view(ready_library, clip.id, Reduction())
    assert slow.motion.frame_rate == 10.0
    assert (
        len(slow.motion.positions) == len(slow.eigen_motion) == (len(usual.eigen_motion) + 2) // 3
    )
    assert np.allclose(slow.motion.positions[5], usual.motion.positions[15], atol=0.03)


@pytest.mark.parametrize("format", ["bvh", "glb", "npz", "csv"])
def test_exported_files_have_the_reduced_motion(
    ready_library: Library, clip_of: FindClip, format: str
) -> None:
    clip = clip_of("ada", "wave")
    shown = view(ready_library, clip.id, Reduction(2, "uniform")).motion
    file = export(ready_library, clip.id, format, reduction=Reduction(2, "uniform"))
    assert file.file_name.endswith(f"-uniform-2dim.{format}")
    names, positions = positions_of(b"".join(file.blocks), format)
    assert sorted(names) == sorted(shown.joint_names)
    order = [shown.joint_names.index(name) for name in names]
    assert np.abs(positions - shown.positions[:, order]).max() < 1e-4


def test_bones_keep_their_length_on_the_canonical_body(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "wave")
    file = export(
        ready_library, clip.id, "bvh", skeleton="canonical", fps=15, reduction=Reduction(2)
    )
    assert file.file_name.endswith("-keypose-2dim-canonical.bvh")
    motion = canonicalize(read_recording(b"".join(file.blocks)))
    assert motion.names == tuple(role.value for role in BODY_ROLES)
    assert motion.frame_rate == pytest.approx(15)
    bone = (
        motion.positions[:, motion.names.index("left_hand")]
        - (motion.positions[:, motion.names.index("left_elbow")])
    )
    assert np.ptp(np.linalg.norm(bone, axis=-1)) < 1e-4


def test_pictures_animate_whole_reduced_and_partial_clips(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "wave")
    whole = animation_svg(ready_library, clip.id)
    reduced = animation_svg(ready_library, clip.id, Reduction(1))
    part = animation_svg(ready_library, clip.id, start=1.0, end=2.0)
    assert whole != reduced
    assert clip.name in whole
    assert 'dur="1.000s"' in part or 'dur="0.9' in part
    assert len(part) < len(whole)
    for picture in (whole, reduced, part):
        ElementTree.fromstring(picture)


@pytest.mark.parametrize(
    ("start", "end", "field"),
    [(99.0, None, "start"), (-1.0, None, "start"), (1.0, 1.0, "end"), (None, float("nan"), "end")],
)
def test_parts_outside_are_refused(
    ready_library: Library, clip_of: FindClip, start: float | None, end: float | None, field: str
) -> None:
    with pytest.raises(BadField) as caught:
        animation_svg(ready_library, clip_of("ada", "walk").id, None, start, end)
    assert [place.location for place in caught.value.places] == [field]


def test_a_file_s_skeleton_has_parents_before_children() -> None:
    order = low_dimensional._parents_first()
    assert sorted(order) == list(range(13))
