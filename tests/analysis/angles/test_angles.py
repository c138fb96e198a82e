"""Joint angles of bodies whose angles are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.angles.angles import JointAngles, angles_of
from app.analysis.angles.definitions import ANGLE_NAMES, explained
from app.analysis.angles.neutral_pose import world_rotations
from app.analysis.angles.segment_frames import Neutral
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.rotations import euler_to_quaternions, rotate
from app.numerics.arrays import FloatArray
from tests.analysis.angles.bodies import ROLES, body, cardan, motion_of, with_other_axes

R = JointRole
FLEXION = np.array([0.0, 30.0, -20.0, 60.0])
ASIDE = np.array([0.0, 10.0, -15.0, 5.0])
TURN = np.array([0.0, -5.0, 12.0, 20.0])
NOTHING = np.zeros(4)


def angles(animation: Animation) -> JointAngles:
    return angles_of(motion_of(animation), animation)


def column(found: JointAngles, name: str) -> FloatArray:
    return found.degrees[:, ANGLE_NAMES.index(name)]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("joint", "names", "sign"),
    [
        ("upper_leg", ("hip_flexion", "hip_adduction", "hip_internal_rotation"), 1),
        ("knee", ("knee_flexion", "knee_adduction", "knee_internal_rotation"), -1),
        ("foot", ("ankle_dorsiflexion", "ankle_inversion", "ankle_internal_rotation"), 1),
    ],
)
def test_a_joint_has_the_angles_that_it_was_given(
    side: str, joint: str, names: tuple[str, ...], sign: int
) -> None:
    inward = 1 if side == "right" else -1
    turn = cardan(sign * FLEXION, inward * ASIDE, inward * TURN)
    found = angles(body(4, {R(f"{side}_{joint}"): turn}))
    assert found.neutral is Neutral.REST_POSE
    for name, expected in zip(names, (FLEXION, ASIDE, TURN), strict=True):
        np.testing.assert_allclose(column(found, f"{side}_{name}_deg"), expected, atol=1e-4)
    moved = {f"{side}_{name}_deg" for name in names}
    for name in ANGLE_NAMES:
        if name not in moved and "shoulder" not in name:
            np.testing.assert_allclose(column(found, name), 0, atol=1e-4, err_msg=name)


def test_the_pelvis_has_its_clinical_angles() -> None:
    rotation, obliquity, tilt = 20.0, 6.0, 11.0
    turn = euler_to_quaternions(np.radians([[rotation, obliquity, -tilt]]), "YXZ")
    found = angles(body(1, {R.HIPS: turn}))
    assert column(found, "pelvis_rotation_deg")[0] == pytest.approx(rotation, abs=1e-4)
    assert column(found, "pelvis_obliquity_deg")[0] == pytest.approx(obliquity, abs=1e-4)
    assert column(found, "pelvis_anterior_tilt_deg")[0] == pytest.approx(tilt, abs=1e-4)
    assert column(found, "trunk_flexion_deg")[0] == pytest.approx(0, abs=1e-4)


def test_the_signs_are_those_of_the_body() -> None:
    """Seen in positions: the left side is higher, the body faces left, the trunk leans forward."""
    turn = euler_to_quaternions(np.radians([[90.0, 10.0, 0.0]]), "YXZ")
    animation = body(1, {R.HIPS: turn})
    left, right = (motion_of(animation).positions[0, motion_of(animation).roles[r]]
                   for r in (R.LEFT_UPPER_LEG, R.RIGHT_UPPER_LEG))  # fmt: skip
    assert left[1] > right[1]
    assert left[2] < right[2]  # it faces +X, so its left is toward -Z
    assert column(angles(animation), "pelvis_obliquity_deg")[0] > 0
    bent = body(1, {R.CHEST: cardan(*np.array([[-30.0], [0.0], [0.0]]))})
    neck = motion_of(bent).positions[0, motion_of(bent).roles[R.NECK]]
    assert neck[2] > 0.01
    assert column(angles(bent), "trunk_flexion_deg")[0] == pytest.approx(30, abs=1e-4)
    assert column(angles(bent), "thorax_anterior_tilt_deg")[0] == pytest.approx(30, abs=1e-4)


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_arm_is_raised_to_the_side_and_forward(side: str) -> None:
    at_rest = angles(body(1, {}))
    assert column(at_rest, f"{side}_shoulder_elevation_deg")[0] == pytest.approx(90, abs=1e-3)
    assert column(at_rest, f"{side}_shoulder_plane_of_elevation_deg")[0] == pytest.approx(
        0, abs=1e-3
    )
    inward = 1.0 if side == "right" else -1.0
    ahead = np.array([inward * 90.0])
    forward = angles(body(1, {R(f"{side}_shoulder"): cardan(0 * ahead, 0 * ahead, ahead)}))
    assert column(forward, f"{side}_shoulder_flexion_deg")[0] == pytest.approx(90, abs=1e-3)
    assert column(forward, f"{side}_shoulder_plane_of_elevation_deg")[0] == pytest.approx(
        90, abs=1e-3
    )
    down = angles(body(1, {R(f"{side}_shoulder"): cardan(0 * ahead, ahead, 0 * ahead)}))
    assert column(down, f"{side}_shoulder_elevation_deg")[0] == pytest.approx(0, abs=1e-3)
    assert column(down, f"{side}_shoulder_internal_rotation_deg")[0] == pytest.approx(0, abs=1e-3)


def test_an_elbow_bends() -> None:
    bent = angles(body(1, {R.LEFT_ELBOW: cardan(*np.array([[0.0], [0.0], [-75.0]]))}))
    assert column(bent, "left_elbow_flexion_deg")[0] == pytest.approx(75, abs=1e-4)
    assert column(bent, "right_elbow_flexion_deg")[0] == pytest.approx(0, abs=1e-4)


@settings(max_examples=25, deadline=None)
@given(
    turn=st.floats(-170, 170),
    hip=st.tuples(*3 * [st.floats(-40, 40)]),
    knee=st.floats(0, 120),
)
def test_the_heading_does_not_matter(
    turn: float, hip: tuple[float, float, float], knee: float
) -> None:
    legs = {
        R.LEFT_UPPER_LEG: cardan(*np.array(hip)[:, None]),
        R.LEFT_KNEE: cardan(*np.array([[-knee], [0.0], [0.0]])),
        # an arm that is held out to the side has no flexion
        R.LEFT_SHOULDER: cardan(*np.array([[0.0], [-60.0], [0.0]])),
        R.RIGHT_SHOULDER: cardan(*np.array([[0.0], [60.0], [0.0]])),
    }
    heading = cardan(*np.array([[0.0], [0.0], [turn]]))
    here, there = angles(body(1, legs)), angles(body(1, legs | {R.HIPS: heading}))
    assert column(there, "pelvis_rotation_deg")[0] == pytest.approx(turn, abs=1e-3)
    same = [n for n in ANGLE_NAMES if not n.endswith("_rotation_deg") or "hip" in n or "knee" in n]
    for name in same:
        np.testing.assert_allclose(column(there, name), column(here, name), atol=1e-3, err_msg=name)


def test_a_rest_pose_that_is_no_person_is_replaced_by_the_most_upright_frame() -> None:
    sway = np.sin(np.linspace(0, 6, 80))
    bend = np.abs(sway)
    turns = {
        R.HIPS: cardan(0 * bend, 4 + sway, 0 * bend),
        R.LEFT_UPPER_LEG: cardan(30 * bend, 4 * sway, 0 * bend),
        R.LEFT_KNEE: cardan(-60 * bend, 0 * bend, 0 * bend),
        R.RIGHT_KNEE: cardan(-50 * bend, 0 * bend, 0 * bend),
        R.CHEST: cardan(-15 * bend, 0 * bend, 5 * sway),
        R.LEFT_FOOT: cardan(10 * bend, 0 * bend, 0 * bend),
    }
    plain = body(80, turns)
    draw = np.random.default_rng(5).normal(size=(len(plain.skeleton), 4))
    axes = draw / np.linalg.norm(draw, axis=1, keepdims=True)
    strange = with_other_axes(plain, axes)
    np.testing.assert_allclose(strange.positions(), plain.positions(), atol=1e-9)
    found, expected = angles(strange), angles(plain)
    assert found.neutral is Neutral.UPRIGHT_POSE
    for name in (
        "pelvis_anterior_tilt_deg", "pelvis_obliquity_deg", "pelvis_rotation_deg",
        "left_hip_flexion_deg", "left_hip_adduction_deg", "left_hip_internal_rotation_deg",
        "left_knee_flexion_deg", "left_knee_adduction_deg", "left_knee_internal_rotation_deg",
        "right_knee_flexion_deg",
    ):  # fmt: skip
        np.testing.assert_allclose(
            column(found, name), column(expected, name), atol=0.5, err_msg=name
        )
    # the thorax stands on hips and neck there, so it is compared by its movement
    moved = column(found, "trunk_flexion_deg") - column(expected, "trunk_flexion_deg")
    assert np.ptp(moved) < 0.5


def test_positions_alone_give_what_they_determine() -> None:
    animation = body(4, {R.LEFT_KNEE: cardan(-np.abs(FLEXION), NOTHING, NOTHING)})
    found = angles_of(motion_of(animation), None)
    assert found.neutral is Neutral.POSITIONS
    np.testing.assert_allclose(column(found, "left_knee_flexion_deg"), np.abs(FLEXION), atol=1e-2)
    np.testing.assert_allclose(column(found, "left_shoulder_elevation_deg"), 90, atol=3)
    for unknown in ("left_hip_flexion_deg", "left_knee_adduction_deg", "pelvis_obliquity_deg",
                    "left_ankle_dorsiflexion_deg", "trunk_flexion_deg"):  # fmt: skip
        assert np.isnan(column(found, unknown)).all(), unknown


def test_pelvis_markers_give_the_pelvis_and_the_hips() -> None:
    tilt = np.array([10.0])
    animation = body(1, {R.HIPS: cardan(-tilt, 0 * tilt, 0 * tilt)})
    motion = motion_of(animation)
    hips = motion.positions[:, [0]]
    places = np.array([[0.12, 0, 0.1], [-0.12, 0, 0.1], [0.05, 0, -0.1], [-0.05, 0, -0.1]])
    leaning = np.radians(10)
    turned = places @ np.array(
        [[1, 0, 0], [0, np.cos(leaning), np.sin(leaning)], [0, -np.sin(leaning), np.cos(leaning)]]
    )
    marked = replace(
        motion,
        names=(*motion.names, "LASI", "RASI", "LPSI", "RPSI"),
        parents=np.append(motion.parents, [-1] * 4),
        positions=np.concatenate([motion.positions, hips + turned], axis=1).astype(np.float32),
    )
    found = angles_of(marked, None)
    assert column(found, "pelvis_anterior_tilt_deg")[0] == pytest.approx(10, abs=0.01)
    assert column(found, "left_hip_flexion_deg")[0] == pytest.approx(0, abs=0.01)
    assert np.isnan(column(found, "left_hip_internal_rotation_deg")).all()


def test_every_angle_is_explained() -> None:
    definitions = explained()
    for name in ANGLE_NAMES:
        assert name.removeprefix("left_").removeprefix("right_") in definitions


def test_markers_on_both_sides_of_a_joint_give_its_three_angles() -> None:
    turns = {}
    for side, inward in (("left", -1), ("right", 1)):
        turns[R(f"{side}_upper_leg")] = cardan(FLEXION, inward * ASIDE, inward * TURN)
        turns[R(f"{side}_knee")] = cardan(-np.abs(FLEXION), inward * ASIDE / 5, inward * TURN)
        turns[R(f"{side}_foot")] = cardan(FLEXION / 3, NOTHING, NOTHING)
    animation = body(4, turns)
    motion, expected = motion_of(animation), angles(animation)
    tracks = {"LASI": (R.HIPS, R.HIPS, (0.12, 0, 0.1)), "RASI": (R.HIPS, R.HIPS, (-0.12, 0, 0.1)),
              "SACR": (R.HIPS, R.HIPS, (0, 0, -0.1))}  # fmt: skip
    for side, out in (("left", 0.05), ("right", -0.05)):
        thigh, shank, foot = (R(f"{side}_{part}") for part in ("upper_leg", "knee", "foot"))
        for name, segment, joint, offset in (
            ("KNE", thigh, shank, (out, 0, 0)), ("KNM", thigh, shank, (-out, 0, 0)),
            ("ANK", shank, foot, (out, 0, 0)), ("ANM", shank, foot, (-out, 0, 0)),
            ("HEE", foot, foot, (0, -0.06, -0.05)), ("TOE", foot, foot, (0, -0.06, 0.15)),
        ):  # fmt: skip
            tracks[f"{side[0].upper()}{name}"] = (segment, joint, offset)
    world = world_rotations(animation)
    added = [
        motion.positions[:, ROLES[joint]] + rotate(world[:, ROLES[segment]], np.array(offset))
        for segment, joint, offset in tracks.values()
    ]
    marked = replace(
        motion,
        names=(*motion.names, *tracks),
        parents=np.append(motion.parents, [-1] * len(tracks)),
        positions=np.concatenate(
            [motion.positions, np.stack(added, axis=1)], axis=1, dtype=np.float32
        ),
    )
    found = angles_of(marked, None)
    for name in ANGLE_NAMES:
        if any(part in name for part in ("pelvis", "hip", "knee", "ankle_dorsi")):
            np.testing.assert_allclose(
                column(found, name), column(expected, name), atol=0.01, err_msg=name
            )
    assert np.isnan(column(found, "left_ankle_inversion_deg")).all()
