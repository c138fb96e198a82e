"""SMPL parameters: exact angles on a generic body, with a caution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.errors import Unreadable
from app.formats.npz.reader import read_npz
from app.formats.npz.smpl import STATURE, generic_body, read_smpl, rotation_vectors_to_quaternions
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.kinematics import rest_positions
from app.numerics.arrays import FloatArray
from tests.formats.npz.files import npz

R = JointRole
UPRIGHT = np.array([np.pi / 2, 0, 0])
"""AMASS has a Y-up model in a Z-up world. The rotation of the root turns it."""


def poses(frames: int = 5, numbers: int = 156, seed: int = 0) -> FloatArray:
    result = np.random.default_rng(seed).uniform(-0.4, 0.4, (frames, numbers))
    result[:, :3] = UPRIGHT
    return result


def test_rotation_vectors_agree_with_scipy() -> None:
    vectors = np.random.default_rng(1).uniform(-4, 4, (50, 3))
    vectors[:2] = [[0, 0, 0], [1e-12, 0, 0]]
    found = rotation_vectors_to_quaternions(vectors)
    expected = Rotation.from_rotvec(vectors).as_quat(canonical=True, scalar_first=True)
    np.testing.assert_allclose(found * np.sign(found[:, :1]), expected, atol=1e-12)


def test_positions_agree_with_4x4_matrices() -> None:
    angles, trans = poses(seed=3), np.random.default_rng(4).uniform(-2, 2, (5, 3))
    recording = read_smpl(angles, trans, 120.0)
    body = generic_body()
    for frame in range(5):
        matrices: list[FloatArray] = []
        for joint, parent in enumerate(body.parents):
            local = np.eye(4)
            vector = angles[frame, 3 * joint : 3 * joint + 3] if joint < 22 else np.zeros(3)
            local[:3, :3] = Rotation.from_rotvec(vector).as_matrix()
            local[:3, 3] = body.offsets[joint] + (trans[frame] if parent < 0 else 0)
            matrices.append(local if parent < 0 else matrices[parent] @ local)
        expected = [matrix[:3, 3] for matrix in matrices]
        np.testing.assert_allclose(recording.positions[frame], expected, atol=1e-5)


def test_an_amass_file_is_upright_with_all_roles_and_a_caution() -> None:
    still = np.zeros((60, 156))
    still[:, :3] = UPRIGHT
    content = npz(
        poses=still, trans=np.tile([1.0, 2.0, 1.1], (60, 1)), mocap_framerate=np.array(120.0),
        betas=np.zeros(16), gender=np.str_("female"), dmpls=np.zeros((60, 8)),
    )  # fmt: skip
    recording = read_npz(content)
    assert recording.frame_rate == 120
    assert recording.rotations is not None
    motion = canonicalize(recording)
    assert motion.missing_roles == ()
    assert [c.code for c in motion.cautions] == ["body_model_missing"]
    assert "angles are exact" in motion.cautions[0].detail
    first = {role: motion.positions[0, joint] for role, joint in motion.roles.items()}
    height = first[R.HEAD][1] - first[R.LEFT_FOOT][1]
    assert 0.8 * STATURE < height < STATURE
    assert first[R.LEFT_HAND][0] > first[R.RIGHT_HAND][0]


def test_a_lying_person_stays_lying() -> None:
    lying = np.zeros((60, 72))
    trans = np.tile([0.0, 0.0, 0.2], (60, 1))
    motion = canonicalize(read_npz(npz(poses=lying, trans=trans, mocap_framerate=60)))
    assert np.ptp(motion.positions[0, :, 1]) < 0.3
    assert [c.code for c in motion.cautions] == ["body_model_missing", "up_axis_suspect"]


def test_y_up_parameters_are_upright() -> None:
    motion = canonicalize(read_npz(npz(poses=np.zeros((60, 72)), fps=60, up_axis="y")))
    assert motion.positions[0, motion.roles[R.HEAD], 1] > motion.positions[0, 0, 1] + 0.3
    assert [c.code for c in motion.cautions] == ["body_model_missing"]


@pytest.mark.parametrize("numbers", [66, 72, 156, 165])
def test_the_body_is_the_same_in_every_model(numbers: int) -> None:
    body = poses(seed=8)[:, :66]
    angles = np.concatenate([body, np.zeros((5, numbers - 66))], axis=1)
    np.testing.assert_allclose(
        read_smpl(angles, None, 30).positions, read_smpl(body, None, 30).positions, atol=1e-6
    )


def test_parameters_in_parts_or_by_joint_give_the_same_recording() -> None:
    angles = poses(numbers=72)
    whole = read_npz(npz(poses=angles, fps=30)).positions
    by_joint = read_npz(npz(poses=angles.reshape(5, 24, 3), fps=30)).positions
    parts = read_npz(npz(root_orient=angles[:, :3], body_pose=angles[:, 3:], fps=30)).positions
    np.testing.assert_array_equal(whole, by_joint)
    np.testing.assert_array_equal(whole, parts)


@pytest.mark.parametrize(
    ("arrays", "location"),
    [
        ({"poses": np.zeros((5, 100))}, "poses"),
        ({"poses": np.zeros((5, 24, 3, 3))}, "poses"),
        ({"poses": np.zeros((5, 72)), "trans": np.zeros((4, 3))}, "trans"),
        ({"poses": np.zeros((5, 72)), "trans": np.array(["a"] * 5)}, "trans"),
        ({"body_pose": np.zeros((5, 63))}, "root_orient"),
        ({"root_orient": np.zeros((4, 3)), "body_pose": np.zeros((5, 63))}, "root_orient"),
        ({"poses": np.where(np.arange(72) == 4, np.nan, np.zeros((5, 72)))}, "frame 0"),
    ],
)
def test_the_error_names_the_key(arrays: dict[str, FloatArray], location: str) -> None:
    with pytest.raises(Unreadable) as refused:
        read_npz(npz(fps=30, **arrays))
    assert refused.value.places[0].location == location


def test_the_generic_body_is_symmetric_and_has_its_stature() -> None:
    body = generic_body()
    rest = dict(zip(body.names, rest_positions(body), strict=True))
    for name, place in rest.items():
        if name.startswith("L_"):
            np.testing.assert_allclose(place * [-1, 1, 1], rest[name.replace("L_", "R_")])
    soles_to_neck = rest["Neck"][1] - rest["L_Foot"][1]
    assert soles_to_neck == pytest.approx(0.85 * STATURE, abs=0.05 * STATURE)
