"""The axis that points up, and roles of two joints, as a client says them."""

from __future__ import annotations

import io

import numpy as np

from app.demo import DemoClip
from app.formats.npz.writer import write_npz
from app.services.clips import catalogue
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.store.clips.record import ClipRecord
from app.store.clips.repository import get
from tests.libraries import upload, work
from tests.motion.roles.test_middles import COCO, joints_only


def analyzed(lib: Library, clip_id: str) -> ClipRecord:
    work(lib.settings)
    with lib.store.read() as tx:
        return get(tx, clip_id)


def test_the_axis_that_a_client_says_is_used_and_can_be_changed(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    created = upload(lib, some_demo_clips[0], up_axis="-Y").clip
    clip = analyzed(lib, created.id)
    assert clip.hints.up_axis == "-y"
    head, foot = (clip.roles[role] for role in ("head", "left_foot"))

    def head_over_foot() -> float:
        motion = load_motion(lib, analyzed(lib, created.id))
        columns = [motion.names.index(name) for name in (head, foot)]
        heights = motion.positions[:, columns, 1].mean(axis=0)
        return float(heights[0] - heights[1])

    assert head_over_foot() < -1
    catalogue.update_clip(lib, created.id, {"up_axis": None})
    assert head_over_foot() > 1


def test_a_role_may_be_the_middle_of_two_joints(lib: Library) -> None:
    names = {role: f"p{index}" for index, role in enumerate(COCO)}
    recording = joints_only(names)
    skeleton = recording.skeleton
    content = write_npz(skeleton.names, skeleton.parents, recording.positions, 30.0)
    roles: dict[str, str | list[str]] = {role.value: name for role, name in names.items()}
    for middle, part in (("hips", "upper_leg"), ("neck", "shoulder")):
        roles[middle] = [str(roles[f"{side}_{part}"]) for side in ("left", "right")]
    created = catalogue.create_clip(lib, io.BytesIO(content), "coco.npz", {"roles": roles}).clip
    clip = analyzed(lib, created.id)
    assert (clip.state, clip.missing_roles) == ("ready", ())
    assert clip.hints.roles == roles
    motion = load_motion(lib, clip)
    hips = motion.positions[:, motion.names.index(clip.roles["hips"])]
    both = [skeleton.names.index(name) for name in roles["hips"]]
    np.testing.assert_allclose(hips, recording.positions[:, both].mean(axis=1), atol=1e-3)
