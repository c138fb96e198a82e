"""Lower bodies and upper bodies are analyzed for what they have."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.analyze import analyze
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_length
from app.motion.motion import Motion
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Recording
from tests.motion.canonical.test_canonical import without
from tests.motion.plausibility.creatures import without_rest
from tests.people import CONVENTIONS, person

R = JointRole
WHOLE = person(CONVENTIONS["MotionBuilder"], frames=60)
LOWER = without(WHOLE, "neck", "head", "chest", "shoulder", "elbow", "hand")
UPPER = without(WHOLE, "leg", "knee", "foot", "toes")


def codes(motion: Motion) -> list[str]:
    return [caution.code for caution in motion.cautions]


@pytest.mark.parametrize("recording", [LOWER, without_rest(LOWER)])
def test_a_lower_body_has_an_estimated_neck_that_counts_as_missing(recording: Recording) -> None:
    motion = canonicalize(recording)
    assert codes(motion) == ["lower_body_only", "roles_missing"]
    assert {R.NECK, R.HEAD, R.LEFT_HAND, R.RIGHT_SHOULDER} <= set(motion.missing_roles)
    neck, hips = (motion.positions[:, motion.roles[role]] for role in (R.NECK, R.HIPS))
    assert np.allclose((neck - hips)[:, [0, 2]], 0, atol=1e-6)
    assert motion.names[motion.roles[R.NECK]] == "estimated_neck"


def test_an_upper_body_has_estimated_knees_that_count_as_missing() -> None:
    motion = canonicalize(UPPER)
    assert codes(motion) == ["upper_body_only", "roles_missing"]
    assert {R.LEFT_KNEE, R.RIGHT_KNEE, R.LEFT_FOOT} <= set(motion.missing_roles)
    left, right = (motion.positions[:, motion.roles[r]] for r in (R.LEFT_KNEE, R.RIGHT_KNEE))
    assert np.all(left[:, 0] > right[:, 0])
    assert np.all(left[:, 1] < motion.positions[:, motion.roles[R.HIPS], 1])


@pytest.mark.parametrize("part", [LOWER, UPPER])
def test_a_part_has_about_the_size_of_the_whole_body(part: Recording) -> None:
    whole = body_length(canonicalize(WHOLE, metres_per_unit=1.0))
    assert body_length(canonicalize(part, metres_per_unit=1.0)) == pytest.approx(whole, rel=0.15)


@pytest.mark.parametrize("part", [LOWER, UPPER])
def test_a_part_is_analyzed_and_posed(part: Recording) -> None:
    motion = canonicalize(part)
    found = analyze(motion)
    assert all(np.isfinite(array).all() for array in found.arrays.values())
    assert np.isfinite(on_canonical_body(motion).positions()).all()


def test_the_legs_of_a_lower_body_move_as_those_of_the_whole() -> None:
    whole, lower = canonicalize(WHOLE), canonicalize(LOWER)
    for role in (R.HIPS, R.LEFT_KNEE, R.RIGHT_FOOT):
        expected = whole.positions[:, whole.roles[role]]
        assert np.allclose(lower.positions[:, lower.roles[role]], expected, atol=1e-6)
