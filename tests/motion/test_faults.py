"""What is said of each file of shared/faults: small inputs of every kind of fault.

`pytest -m slow -s tests/motion/test_faults.py` prints the table.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from app.formats.read import read_recording
from app.kinedex_error import KinedexError
from app.motion.canonical.canonical import canonicalize
from app.motion.canonical.units import stature
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole

R = JointRole
ROOT = Path(__file__).resolve().parents[2]
ENDINGS = (".bvh", ".fbx", ".c3d", ".npz", ".npy", ".amc")


@dataclass(frozen=True, slots=True)
class Right:
    """What must be said. refused: a part of the problem; cautions: codes that must be there;
    roles: joint names; stature: m; head: of the head over the left foot, m; silent: no caution."""

    refused: str | None = None
    cautions: tuple[str, ...] = ()
    roles: Mapping[JointRole, str] = field(default_factory=dict)
    stature: float | None = None
    head: float | None = None
    silent: bool = False


RIGHT: dict[str, Right] = {
    "dog_biped_names.bvh": Right(refused="not a human body"),
    "rigify_def_duplicates_split_limbs.bvh": Right(
        roles={
            R.LEFT_UPPER_LEG: "DEF-thigh.L.002",
            R.LEFT_KNEE: "DEF-shin.L.002",
            R.LEFT_SHOULDER: "DEF-upper_arm.L.002",
        },
        silent=True,
    ),
    "zup_world_yup_rest_walk.bvh": Right(cautions=("up_axis_guessed",), head=1.38),
    "lying_blender_export.fbx": Right(head=0.0, silent=True),
    "no_neck_chest_head.bvh": Right(roles={R.NECK: "chest", R.HEAD: "head"}, silent=True),
    "no_neck_plain_names_accepted.bvh": Right(roles={R.NECK: "Spine"}, silent=True),
    "rigify_metarig_short_legs.bvh": Right(roles={R.NECK: "spine.004", R.HEAD: "spine.006"}),
    "advanced_skeleton_M.bvh": Right(roles={R.NECK: "Neck_M"}, silent=True),
    "cmu_lhipjoint_lefthip.bvh": Right(roles={R.LEFT_UPPER_LEG: "LeftHip"}, silent=True),
    "offset_with_zero_position_channels.bvh": Right(
        cautions=("position_channels_unused",), stature=1.71
    ),
    "frame_time_1_walk.bvh": Right(cautions=("frame_rate_suspect",)),
    "child_1m.bvh": Right(cautions=("unit_guessed",), stature=1.03),
    "glued_numbers.bvh": Right(refused="line 135"),
    "f01_smplx_y_up.npz": Right(cautions=("up_axis_guessed",), head=1.48),
    "f03_right.c3d": Right(silent=True),
    "f05_joints_with_collar.c3d": Right(stature=1.76, silent=True),
    "f06_arms_swapped.c3d": Right(cautions=("sides_suspect",)),
    "f06b_marker_frozen_on_floor.c3d": Right(cautions=("marker_frozen",)),
    "f06c_sentinel_9999.c3d": Right(cautions=("gaps_filled",), stature=1.8),
    "f10c_lower_body_gait.c3d": Right(cautions=("lower_body_only",)),
    "f11d_left_first.npy": Right(cautions=("sides_suspect",)),
    "f14_coco_names.npz": Right(cautions=("joints_made",), head=1.54),
}
"""The right answers of the files that are about the meaning of bodies."""


def files() -> Iterator[Path]:
    folder = Path(os.environ.get("KINEDEX_FAULTS") or ROOT / ".." / "shared" / "faults")
    found = sorted(path for path in folder.rglob("*") if path.suffix in ENDINGS)
    if not found:
        pytest.skip("FAULTS ABSENT: set KINEDEX_FAULTS to the folder of faults")
    yield from found


def read(path: Path) -> Motion:
    skeleton = path.with_suffix(".asf").read_bytes() if path.suffix == ".amc" else None
    recording = read_recording(path.read_bytes(), skeleton)
    return canonicalize(recording, frame_rate=recording.frame_rate or 30.0)


def wrong(motion: Motion, right: Right) -> list[str]:
    """What is not as it must be."""
    codes = [caution.code for caution in motion.cautions]
    names = {role: motion.names[joint] for role, joint in motion.roles.items()}
    height = stature(motion.positions, motion.roles)
    over = motion.positions[:, motion.roles.get(R.HEAD, motion.roles[R.NECK]), 1]
    head = float((over - motion.positions[:, motion.roles[R.LEFT_FOOT], 1]).mean())
    found = [f"no caution {code}" for code in right.cautions if code not in codes]
    found += [f"{r}: {names.get(r)}" for r, name in right.roles.items() if names.get(r) != name]
    if right.silent and codes:
        found.append(f"cautions {codes}")
    if right.stature is not None and abs(height - right.stature) > 0.03:
        found.append(f"stature {height:.2f}")
    if right.head is not None and abs(head - right.head) > 0.05:
        found.append(f"head {head:.2f} over the foot")
    return found


@pytest.mark.slow
def test_each_file_of_faults_gets_its_right_answer() -> None:
    mistakes: dict[str, list[str]] = {}
    for path in files():
        right = RIGHT.get(path.name)
        try:
            motion = read(path)
        except KinedexError as problem:
            print(f"| {path.name} | refused, {problem.code}: {problem.detail[:150]} |")
            if right is not None and (right.refused is None or right.refused not in problem.detail):
                mistakes[path.name] = [problem.detail]
            continue
        said = "; ".join(f"{c.code}: {c.detail[:90]}" for c in motion.cautions) or "no caution"
        print(f"| {path.name} | ready, {stature(motion.positions, motion.roles):.2f} m; {said} |")
        if right is not None:
            refused = ["not refused"] if right.refused else []
            mistakes |= {path.name: found} if (found := refused + wrong(motion, right)) else {}
    assert mistakes == {}
