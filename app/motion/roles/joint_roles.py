"""Joint roles: the 13 joints of Sun 2011 (section 2.2, fig. 2), by meaning, not by name."""

from __future__ import annotations

from enum import StrEnum


class JointRole(StrEnum):
    """The meaning of a joint in the body. The first 13 roles have the order of Sun 2011."""

    LEFT_KNEE = "left_knee"
    RIGHT_KNEE = "right_knee"
    LEFT_FOOT = "left_foot"
    RIGHT_FOOT = "right_foot"
    HIPS = "hips"
    LEFT_ELBOW = "left_elbow"
    RIGHT_ELBOW = "right_elbow"
    LEFT_SHOULDER = "left_shoulder"
    RIGHT_SHOULDER = "right_shoulder"
    NECK = "neck"
    HEAD = "head"
    LEFT_HAND = "left_hand"
    RIGHT_HAND = "right_hand"
    LEFT_TOES = "left_toes"
    RIGHT_TOES = "right_toes"
    CHEST = "chest"
    LEFT_UPPER_LEG = "left_upper_leg"
    RIGHT_UPPER_LEG = "right_upper_leg"

    def toward_trunk(self) -> JointRole:
        """The neighboring role that is nearer to the hips; for the hips, the hips."""
        return _TOWARDS_TRUNK[self]

    def mirrored(self) -> JointRole:
        """The same role on the other side; a middle role is its own mirror."""
        name = self.value
        if name.startswith("left_"):
            return JointRole("right_" + name.removeprefix("left_"))
        if name.startswith("right_"):
            return JointRole("left_" + name.removeprefix("right_"))
        return self


SUN_ROLES: tuple[JointRole, ...] = tuple(JointRole)[:13]
"""Sun's order of the 13 joints. It is also the order of a query by pose."""

ESSENTIAL_ROLES: tuple[JointRole, ...] = (
    JointRole.HIPS,
    JointRole.LEFT_KNEE,
    JointRole.RIGHT_KNEE,
    JointRole.NECK,
)
"""Without these roles there is no body frame. Only the lower or the upper half of a body may lack
some of them; else a skeleton without them is refused."""

_R = JointRole
_TOWARDS_TRUNK: dict[JointRole, JointRole] = {
    _R.LEFT_KNEE: _R.HIPS,
    _R.RIGHT_KNEE: _R.HIPS,
    _R.LEFT_FOOT: _R.LEFT_KNEE,
    _R.RIGHT_FOOT: _R.RIGHT_KNEE,
    _R.HIPS: _R.HIPS,
    _R.LEFT_ELBOW: _R.LEFT_SHOULDER,
    _R.RIGHT_ELBOW: _R.RIGHT_SHOULDER,
    _R.LEFT_SHOULDER: _R.NECK,
    _R.RIGHT_SHOULDER: _R.NECK,
    _R.NECK: _R.HIPS,
    _R.HEAD: _R.NECK,
    _R.LEFT_HAND: _R.LEFT_ELBOW,
    _R.RIGHT_HAND: _R.RIGHT_ELBOW,
    _R.LEFT_TOES: _R.LEFT_FOOT,
    _R.RIGHT_TOES: _R.RIGHT_FOOT,
    _R.CHEST: _R.HIPS,
    _R.LEFT_UPPER_LEG: _R.HIPS,
    _R.RIGHT_UPPER_LEG: _R.HIPS,
}

SUN_PARENTS: tuple[int, ...] = tuple(
    -1 if (nearer := role.toward_trunk()) is role else SUN_ROLES.index(nearer) for role in SUN_ROLES
)
"""(13,) the index of the neighbor toward the trunk of each of SUN_ROLES; -1 for the hips."""
