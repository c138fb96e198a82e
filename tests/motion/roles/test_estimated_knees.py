"""Knees are estimated for marker sets without them, near their true places."""

from __future__ import annotations

import numpy as np
import pytest

from app.motion.canonical.canonical import canonicalize
from app.motion.roles.estimated_knees import with_missing_knees
from app.motion.roles.joint_roles import JointRole
from tests.motion.plausibility.creatures import without_rest
from tests.people import CONVENTIONS, ROLES, person

R = JointRole
PERSON = person(CONVENTIONS["MotionBuilder"], frames=120)
ALL = {role: index for index, role in enumerate(ROLES)}
KNEES = (R.LEFT_KNEE, R.RIGHT_KNEE)


@pytest.mark.parametrize("missing", [KNEES, KNEES[:1]])
def test_knees_are_near_their_true_places(missing: tuple[JointRole, ...]) -> None:
    known = {role: joint for role, joint in ALL.items() if role not in missing}
    recording, found, cautions = with_missing_knees(PERSON, known)
    assert [caution.code for caution in cautions] == ["knees_estimated"]
    assert list(found) == [role for role in JointRole if role in ALL]
    for knee in missing:
        true = PERSON.positions[:, ALL[knee]]
        away = np.linalg.norm(recording.positions[:, found[knee]] - true, axis=1)
        assert np.percentile(away, 90) < 0.1
        assert recording.skeleton.names[found[knee]] in cautions[0].detail


@pytest.mark.parametrize("lacking", ["left_toes", "right_upper_leg", "left_foot"])
def test_knees_are_not_estimated_without_the_rest_of_the_leg(lacking: str) -> None:
    known = {role: joint for role, joint in ALL.items() if role not in (*KNEES, R(lacking))}
    assert with_missing_knees(PERSON, known) == (PERSON, known, ())


def test_a_body_with_knees_is_the_same() -> None:
    assert with_missing_knees(PERSON, ALL) == (PERSON, ALL, ())


def test_a_leg_without_length_has_a_finite_knee() -> None:
    still = without_rest(PERSON)
    still.positions[:] = 1.0
    known = {role: joint for role, joint in ALL.items() if role not in KNEES}
    recording, found, _ = with_missing_knees(still, known)
    assert np.array_equal(recording.positions[:, found[R.LEFT_KNEE]], still.positions[:, 0])


def test_markers_on_thigh_and_shank_are_enough() -> None:
    names = dict(CONVENTIONS["MotionBuilder"])
    names |= {knee: f"{knee}_cluster" for knee in KNEES}
    recording = without_rest(person(names, frames=120))
    recording.skeleton.parents[:] = -1
    motion = canonicalize(recording)
    assert [caution.code for caution in motion.cautions] == ["knees_estimated"]
    assert motion.missing_roles == ()
