"""The canonical motion: meters, Y up, right-handed, with known joint roles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Motion:
    """A clip's motion in canonical form.

    names: (joints,). parents: (joints,) int, -1 for a root. positions: (frames, joints, 3)
    float32, in the world, meters, Y up. roles: the joint of each role that was found.
    missing_roles: the roles of Sun's 13 that were not found. frame_rate: Hz, the one that is used.
    declared_frame_rate: Hz as in the file, or None. metres_per_unit: the scale that was applied to
    the numbers of the file. start_offset: seconds from the start of the file to the first frame.
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
    start_offset: float = 0.0

    @property
    def frames(self) -> int:
        """Number of frames."""
        return int(self.positions.shape[0])

    @property
    def duration(self) -> float:
        """Seconds: frames / frame_rate."""
        return self.frames / self.frame_rate

    def role_positions(self) -> FloatArray:
        """(frames, 13, 3) float32 positions of Sun's 13 roles, in meters, in SUN_ROLES order.

        A missing role gets the position of its nearest neighbor toward the trunk that is there
        (hand -> elbow -> shoulder -> neck), so that all arrays have the same shape.
        """
        columns = [self.roles[self._nearest_found(role)] for role in SUN_ROLES]
        return np.ascontiguousarray(self.positions[:, columns])

    def _nearest_found(self, role: JointRole) -> JointRole:
        # This ends at the latest at the hips, which every motion has.
        while role not in self.roles:
            role = role.toward_trunk()
        return role
