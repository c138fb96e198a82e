"""Joint centers: left stays left, and they move with the markers."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.roles.joint_centers import RECIPES, joint_centers
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.rotations import euler_to_quaternions, rotate
from tests.formats.c3d.files import marker_person

TRACKS, _ = marker_person(frames=10)


def test_every_role_has_a_recipe() -> None:
    assert set(RECIPES) == set(JointRole)
    assert set(joint_centers(TRACKS)) == set(JointRole)


def test_centers_are_turned_moved_and_scaled_with_the_markers() -> None:
    turn = euler_to_quaternions(np.array([0.3, 1.0, -2.0]), "XYZ")
    moved = {place: 2 * rotate(turn, track) + [1, 2, 3] for place, track in TRACKS.items()}
    before, after = joint_centers(TRACKS), joint_centers(moved)
    for role, center in before.items():
        assert np.allclose(after[role].positions, 2 * rotate(turn, center.positions) + [1, 2, 3])


def test_trochanters_give_the_hips_without_a_pelvis() -> None:
    tracks = {"LGTR": np.array([[0.2, 1.0, 0.0]]), "RGTR": np.array([[-0.2, 1.0, 0.0]])}
    centers = joint_centers(tracks)
    found = {role: center.positions[0].tolist() for role, center in centers.items()}
    assert found == {
        JointRole.HIPS: [0.0, 1.0, 0.0],
        JointRole.LEFT_UPPER_LEG: [0.1, 1.0, 0.0],
        JointRole.RIGHT_UPPER_LEG: [-0.1, 1.0, 0.0],
    }


def test_a_mirrored_person_has_mirrored_joints() -> None:
    def other(place: str) -> str:
        return {"L": "R", "R": "L"}.get(place[0], place[0]) + place[1:]

    sides = {place: track for place, track in TRACKS.items() if other(place) in TRACKS}
    mirrored = {other(place): track * [-1, 1, 1] for place, track in sides.items()}
    before, after = joint_centers(sides), joint_centers(mirrored)
    for role, center in before.items():
        assert np.allclose(after[role.mirrored()].positions, center.positions * [-1, 1, 1])


@pytest.mark.parametrize("missing", ["LASI", "LKNE", "C7", "LWRA", "LFHD"])
def test_a_missing_marker_changes_only_its_joints(missing: str) -> None:
    fewer = {place: track for place, track in TRACKS.items() if place != missing}
    before, after = joint_centers(TRACKS), joint_centers(fewer)
    for role, center in before.items():
        if missing not in center.places:
            assert np.array_equal(after[role].positions, center.positions)


def test_markers_at_one_point_give_finite_centers() -> None:
    here = {place: np.zeros((3, 3)) for place in TRACKS}
    assert all(np.array_equal(c.positions, np.zeros((3, 3))) for c in joint_centers(here).values())
