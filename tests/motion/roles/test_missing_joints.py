"""A skeleton without essential joints is refused with the names that it has."""

from __future__ import annotations

from app.motion.roles.joint_roles import JointRole
from app.motion.roles.missing_joints import no_joints_for


def test_the_error_lists_the_names_of_the_file() -> None:
    error = no_joints_for([JointRole.HIPS, JointRole.NECK], ["box", "lid"])
    assert "hips, neck" in error.detail
    assert "box, lid" in error.detail
    assert "`roles`" in error.detail
    locations = [place.location for place in error.places]
    assert locations == ["roles.hips", "roles.neck", "joints"]


def test_long_lists_are_cut() -> None:
    error = no_joints_for([JointRole.HIPS], [f"marker {n}" for n in range(500)])
    assert "420 more" in error.places[-1].message or "420 more" in error.detail
