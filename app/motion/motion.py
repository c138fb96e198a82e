"""The canonical motion (DESIGN 4): meters, Y up, right-handed, joint roles known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Motion:
    """A clip's motion in canonical form.

    names: (joints,); parents: (joints,) int, -1 for a root;
    positions: (frames, joints, 3) float32, meters, Y up, world frame;
    roles: joint index by role, found roles only; missing_roles: those of Sun's 13 not found;
    frame_rate: Hz, the one in force; declared_frame_rate: Hz as in the file, or None;
    metres_per_unit: scale that was applied to the file's numbers.
    """

    format: str
    names: tuple[str, ...]
    parents: IntArray
    positions: FloatArray
    roles: dict[JointRole, int]
    missing_roles: tuple[JointRole, ...]
    frame_rate: float
    declared_frame_rate: float | None
    metres_per_unit: float
    cautions: tuple[Caution, ...] = ()

    @property
    def frames(self) -> int:
        """Number of frames."""
        return int(self.positions.shape[0])

    @property
    def duration(self) -> float:
        """Seconds: frames / frame_rate."""
        return self.frames / self.frame_rate

    def role_positions(self) -> FloatArray:
        """(frames, 13, 3) float32 positions of Sun's 13 roles, meters, in SUN_ROLES order.

        A missing role stands where its nearest present neighbor toward the trunk is
        (hand -> elbow -> shoulder -> neck), so that all arrays keep their shape.
        """
        columns = [self.roles[self._stand_in(role)] for role in SUN_ROLES]
        return np.ascontiguousarray(self.positions[:, columns])

    def _stand_in(self, role: JointRole) -> JointRole:
        while role not in self.roles:
            role = role.towards_trunk()
        return role
