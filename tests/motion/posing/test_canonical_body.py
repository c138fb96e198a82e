"""Clips on the canonical body: fixed bone lengths, directions of the clip, feet on the floor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.demo import demo_clips
from app.formats.bvh.reader import read_bvh
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.posing.canonical_body import (
    ANKLE_HEIGHT,
    BODY_ROLES,
    canonical_body,
    on_canonical_body,
)
from app.motion.roles.joint_roles import ESSENTIAL_ROLES, SUN_ROLES, JointRole
from app.motion.skeleton.kinematics import rest_positions
from app.numerics.arrays import FloatArray
from tests.people import CONVENTIONS, person
from tests.real_clips import manifest, real_clips

R = JointRole
FEET = [BODY_ROLES.index(R.LEFT_FOOT), BODY_ROLES.index(R.RIGHT_FOOT)]
BONES = (
    (R.LEFT_UPPER_LEG, R.LEFT_KNEE), (R.RIGHT_KNEE, R.RIGHT_FOOT),
    (R.LEFT_SHOULDER, R.LEFT_ELBOW), (R.RIGHT_ELBOW, R.RIGHT_HAND), (R.NECK, R.HEAD),
)  # fmt: skip
TENTHS_OF_A_DEGREE = 0.1


def demo_motion(actor: str, task: str) -> Motion:
    return canonicalize(read_bvh(next(demo_clips([actor], [task], takes=1)).content))


def angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """(frames,) the angles in degrees between vectors (frames, 3)."""
    cosine = np.sum(one * other, axis=-1) / (
        np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    )
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def bone(positions: FloatArray, start: JointRole, end: JointRole) -> FloatArray:
    return np.asarray(positions[:, BODY_ROLES.index(end)] - positions[:, BODY_ROLES.index(start)])


def check(motion: Motion) -> None:
    """Check that lengths are fixed, directions are those of the clip, and so is the lower foot."""
    animation = on_canonical_body(motion)
    positions = animation.positions()
    body = canonical_body()
    lengths = np.linalg.norm(positions[:, 1:] - positions[:, body.parents[1:]], axis=-1)
    np.testing.assert_allclose(
        lengths, np.broadcast_to(np.linalg.norm(body.offsets[1:], axis=-1), lengths.shape)
    )
    for start, end in BONES:
        if start in motion.roles and end in motion.roles:
            bone_of_clip = (
                motion.positions[:, motion.roles[end]] - motion.positions[:, motion.roles[start]]
            )
            assert angle(bone(positions, start, end), bone_of_clip).max() < TENTHS_OF_A_DEGREE
    lower = positions[:, FEET, 1].min(axis=1)
    assert np.percentile(lower, 5) == pytest.approx(ANKLE_HEIGHT, abs=1e-6)
    feet_of_clip = motion.positions[:, [motion.roles[R.LEFT_FOOT], motion.roles[R.RIGHT_FOOT]], 1]
    heights = feet_of_clip.min(axis=1).astype(float)
    slope = np.ptp(lower) / np.ptp(heights)
    np.testing.assert_allclose(lower - lower[0], slope * (heights - heights[0]), atol=1e-4)


@pytest.mark.parametrize(
    ("actor", "task"), [("ada", "walk"), ("bruno", "jump"), ("chika", "kick"), ("dele", "bow")]
)
def test_demo_motions_are_moved_to_the_canonical_body(actor: str, task: str) -> None:
    check(demo_motion(actor, task))


@pytest.mark.parametrize("name", CONVENTIONS)
def test_skeletons_of_all_conventions_are_moved_to_it(name: str) -> None:
    check(canonicalize(person(CONVENTIONS[name])))


def test_a_taller_person_gives_the_same_movement() -> None:
    motion = demo_motion("ada", "walk")
    taller = replace(motion, positions=motion.positions * np.float32(1.3))
    np.testing.assert_allclose(
        on_canonical_body(motion).positions(), on_canonical_body(taller).positions(), atol=1e-4
    )


def test_standing_feet_slide_no_more_than_in_the_clip() -> None:
    motion = demo_motion("ada", "walk")
    columns = [motion.roles[R.LEFT_FOOT], motion.roles[R.RIGHT_FOOT]]
    speed = np.linalg.norm(np.diff(motion.positions[:, columns], axis=0), axis=-1)
    low = motion.positions[1:, columns, 1] < motion.positions[:, columns, 1].min() + 0.02
    stands = low & (speed < 0.003)
    assert stands.sum() > 10
    feet = on_canonical_body(motion).positions()[:, FEET]
    slides = np.linalg.norm(np.diff(feet, axis=0), axis=-1)[stands]
    assert np.median(slides) < 0.004


def test_missing_roles_keep_the_rest_pose() -> None:
    motion = demo_motion("ada", "walk")
    bare = replace(motion, roles={r: j for r, j in motion.roles.items() if r in ESSENTIAL_ROLES})
    animation = on_canonical_body(bare)
    elbow = BODY_ROLES.index(R.LEFT_ELBOW)
    np.testing.assert_allclose(animation.rotations[:, elbow, 0], 1.0)
    assert np.isfinite(animation.positions()).all()
    thirteen = replace(motion, roles={r: motion.roles[r] for r in SUN_ROLES})
    full = on_canonical_body(motion).positions()
    without = on_canonical_body(thirteen).positions()
    hands = [BODY_ROLES.index(R.LEFT_HAND), BODY_ROLES.index(R.RIGHT_HAND)]
    assert np.abs((full - full[:, :1])[:, hands] - (without - without[:, :1])[:, hands]).max() < 0.1


def test_a_body_without_size_gives_finite_poses() -> None:
    motion = demo_motion("ada", "walk")
    point = replace(motion, positions=np.zeros_like(motion.positions[:3]))
    assert np.isfinite(on_canonical_body(point).positions()).all()


def test_the_body_stands_on_the_floor_and_is_symmetric() -> None:
    body = canonical_body()
    rest = dict(zip(BODY_ROLES, rest_positions(body), strict=True))
    assert rest[R.LEFT_FOOT][1] == pytest.approx(ANKLE_HEIGHT, abs=0.005)
    for role, place in rest.items():
        np.testing.assert_allclose(place * [-1, 1, 1], rest[role.mirrored()])
    assert body.names == tuple(role.value for role in BODY_ROLES)


@pytest.mark.slow
def test_real_clips_are_moved_to_it() -> None:
    folder, rows = real_clips(), manifest()
    bvh = [row["path"] for row in rows if row["path"].endswith(".bvh")]
    for path in bvh[:: len(bvh) // 40]:
        check(canonicalize(read_bvh((folder / path).read_bytes()), frame_rate=30.0))
