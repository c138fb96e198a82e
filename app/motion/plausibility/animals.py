"""Refuses bodies that are not human, although human roles were found for their joints.

An animal with a human skeleton's names, or with limbs of similar shape, gets roles like a person.
Several signs are added, because people crawl, dance on their hands and wear tails, and cartoon
people have short legs. A human body has legs that are long in comparison with its trunk: by Drillis
and Contini (1966) 1.7 times as long as the way from the hips to the neck. Of a dog they are .7 to
1 times as long.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from app.errors import NotHuman
from app.kinedex_error import Place
from app.motion.motion import Motion
from app.motion.plausibility.animal_names import Names, named_signs
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.resampling import some_frames
from app.numerics.arrays import BoolArray, FloatArray

MIN_WEIGHT = 3
"""The sum of the weights of signs from which on a body is not human."""
MAX_SAMPLED_FRAMES = 64
"""The most frames, evenly spaced, in which the signs are measured."""
MOST_FRAMES = 0.75
"""The share of frames in which a posture must be seen."""
MAX_LEVEL = 0.7
"""The largest rise of a level trunk, as a share of its length (45 degrees)."""
MIN_UPRIGHT = 0.8
"""The smallest rise of an upright trunk, as a share of its length (53 degrees)."""
MAX_HAND_CLEARANCE, MIN_ARM_DROP = 0.4, 0.6
"""The largest height of a hand that bears weight above the lower foot, and the smallest height of
the shoulder above this hand, as shares of the arm's length."""
MIN_HIP_HEIGHT = 0.55
"""The height of the hips above the lower foot, as a share of the leg. Knees on the floor have
less."""
SHORT_LEGS, HUMAN_LEGS = 1.1, 1.3
"""Leg lengths per distance from the hips to the neck: of an animal below, of a person above."""
MAX_LEVEL_REST = 0.6
"""The largest cosine between trunk and legs of a rest pose in which the trunk is level."""
MAX_UPRIGHT_REST = -0.8
"""The largest cosine between trunk and legs of a rest pose that stands upright."""

_R = JointRole


@dataclass(frozen=True, slots=True)
class _Sign:
    """A sign that a body is an animal. weight: below 0 for a sign that it is a person."""

    weight: int
    reason: str


def refuse_animals(motion: Motion, rest: FloatArray | None) -> None:
    """Raise NotHuman with the reasons if the body of `motion` is not human.

    rest: (joints, 3) the rest pose in any axes, or None if the file has no rest pose.
    """
    body, named = _Body(motion), list(_named(motion))
    # Without signs in names, no other signs are enough against an upright trunk.
    if not named and body.is_upright():
        return
    signs = [*_postures(body), *_proportions(body), *_rest_pose(motion, rest), *named]
    if sum(sign.weight for sign in signs) < MIN_WEIGHT:
        return
    reasons = ", ".join(sign.reason for sign in signs if sign.weight > 0)
    raise NotHuman(
        f"This is not a human body: {reasons}. If it is a person, send `roles`.",
        places=[Place("skeleton", reasons)],
    )


class _Body:
    """The limbs of a motion in some frames; all vectors (frames, 3) in meters, Y up."""

    def __init__(self, motion: Motion) -> None:
        sampled = some_frames(motion.positions, MAX_SAMPLED_FRAMES)
        self.motion = replace(motion, positions=sampled)
        self.has_arms = all(
            JointRole(f"{side}_{part}") in motion.roles
            for side in ("left", "right")
            for part in ("shoulder", "elbow")
        )
        neck, hips = (self.motion.positions[:, motion.roles[r]] for r in (_R.NECK, _R.HIPS))
        trunk = neck.astype(np.float64) - hips
        lengths = np.linalg.norm(trunk, axis=1)
        self.trunk_length = float(np.median(lengths))
        self.rise = trunk[:, 1] / np.maximum(lengths, 1e-9)

    @cached_property
    def joints(self) -> dict[JointRole, FloatArray]:
        """The positions of Sun's roles and of the upper legs."""
        roles = self.motion.role_positions().astype(np.float64)
        found: dict[JointRole, FloatArray] = {
            role: roles[:, index] for index, role in enumerate(SUN_ROLES)
        }
        for role in (_R.LEFT_UPPER_LEG, _R.RIGHT_UPPER_LEG):
            joint = self.motion.roles.get(role, self.motion.roles[_R.HIPS])
            found[role] = self.motion.positions[:, joint].astype(np.float64)
        return found

    @cached_property
    def leg_length(self) -> float:
        """The length of the left leg in meters."""
        return self._limb(_R.LEFT_UPPER_LEG, _R.LEFT_KNEE, _R.LEFT_FOOT)

    @cached_property
    def arm_length(self) -> float:
        """The length of the left arm in meters."""
        return self._limb(_R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND)

    @cached_property
    def lower_foot(self) -> FloatArray:
        """(frames,) the height of the lower foot in meters."""
        return np.minimum(self._height(_R.LEFT_FOOT), self._height(_R.RIGHT_FOOT))

    def stands_on_hands_too(self) -> bool:
        """Whether the trunk is level in most frames, and a hand below its shoulder is as low as the
        feet."""
        if not self.has_arms:
            return False
        bears = np.zeros(len(self.rise), dtype=bool)
        for hand, shoulder in (
            (_R.LEFT_HAND, _R.LEFT_SHOULDER),
            (_R.RIGHT_HAND, _R.RIGHT_SHOULDER),
        ):
            clearance = self._height(hand) - self.lower_foot
            drop = self._height(shoulder) - self._height(hand)
            bears |= (clearance < MAX_HAND_CLEARANCE * self.arm_length) & (
                drop > MIN_ARM_DROP * self.arm_length
            )
        return float(np.mean(bears & self.is_level())) >= MOST_FRAMES

    def is_level(self) -> BoolArray:
        """(frames,) whether the trunk is level."""
        return np.asarray(np.abs(self.rise) < MAX_LEVEL)

    def is_held_level(self) -> bool:
        """Whether the legs hold a level trunk above the feet in most frames."""
        held = self._height(_R.HIPS) - self.lower_foot > MIN_HIP_HEIGHT * self.leg_length
        return float(np.mean(held & self.is_level())) >= MOST_FRAMES

    def is_upright(self) -> bool:
        """Whether the trunk is upright in most frames."""
        return float(np.mean(self.rise > MIN_UPRIGHT)) >= MOST_FRAMES

    def _height(self, role: JointRole) -> FloatArray:
        return self.joints[role][:, 1]

    def _limb(self, upper: JointRole, middle: JointRole, end: JointRole) -> float:
        """The length of a limb in meters."""
        lower = self.joints[end] - self.joints[middle]
        return _length(self.joints[middle] - self.joints[upper]) + _length(lower)


def _postures(body: _Body) -> Iterator[_Sign]:
    if body.stands_on_hands_too():
        yield _Sign(2, "it stands on four limbs")
    if body.is_held_level():
        yield _Sign(1, "its trunk is level")
    if body.is_upright():
        yield _Sign(-1, "its trunk is upright")


def _proportions(body: _Body) -> Iterator[_Sign]:
    if body.trunk_length <= 0 or body.leg_length <= 0:
        return
    share = body.leg_length / body.trunk_length
    if share < SHORT_LEGS:
        yield _Sign(1, f"its legs have {share:.2f} times the length of its trunk")
    elif share > HUMAN_LEGS:
        yield _Sign(-2, "its legs are as long as those of a person")


def _rest_pose(motion: Motion, rest: FloatArray | None) -> Iterator[_Sign]:
    roles = motion.roles
    if rest is None or _R.LEFT_FOOT not in roles or _R.RIGHT_FOOT not in roles:
        return
    trunk = rest[roles[_R.NECK]] - rest[roles[_R.HIPS]]
    legs = (rest[roles[_R.LEFT_FOOT]] + rest[roles[_R.RIGHT_FOOT]]) / 2 - rest[roles[_R.HIPS]]
    possible = float(np.linalg.norm(trunk) * np.linalg.norm(legs))
    if possible <= 0:
        return
    cosine = float(trunk @ legs) / possible
    if abs(cosine) < MAX_LEVEL_REST:
        yield _Sign(2, "its trunk is level in the rest pose")
    elif cosine < MAX_UPRIGHT_REST:
        yield _Sign(-2, "it stands upright in the rest pose")


def _named(motion: Motion) -> Iterator[_Sign]:
    parents = tuple(motion.parents.tolist())
    names = Names(motion.names, parents, tuple(motion.roles.items()))
    yield from (_Sign(weight, reason) for weight, reason in named_signs(names))


def _length(vectors: FloatArray) -> float:
    return float(np.median(np.linalg.norm(vectors, axis=-1)))
