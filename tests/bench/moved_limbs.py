"""Poses of a clip with its limbs moved: the poses of another body that does the same.

Legs (knee and foot together), elbows and hands move by constant vectors in the body frame. This
changes neither the body length nor the shoulders, which define the body frame. So each vector of
the clip's pose cover moves by the same constant, and the radii stay: the cover of the moved poses
is known without a computation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.pose_cover import POSE_WIDTH
from app.motion.frame.body_pose import body_poses
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

_R = JointRole
TOGETHER = (
    (_R.LEFT_KNEE, _R.LEFT_FOOT),
    (_R.RIGHT_KNEE, _R.RIGHT_FOOT),
    (_R.LEFT_ELBOW,),
    (_R.RIGHT_ELBOW,),
    (_R.LEFT_HAND,),
    (_R.RIGHT_HAND,),
)
"""Joints that move by the same vector."""
SPREAD = 0.006
"""Deviation of the noise on each coordinate, in body lengths. Poses then move by .01 (root mean
square of the joints): a third of the median distance (.030) of a pose to the nearest pose of
another clip, for 166 real clips."""
_FACTS = 2
"""Columns of a pose cover before its vectors: frame and radius."""


@dataclass(frozen=True)
class Limbs:
    """The poses of a clip, ready to be moved.

    positions: (n, 13, 3). turns: (n,) complex, from a horizontal vector x + iz of the body frame
    to one of the positions. sizes: (n,) body lengths in the unit of the positions. cover: (k, 38).
    """

    positions: FloatArray
    turns: np.ndarray
    sizes: FloatArray
    cover: FloatArray

    @classmethod
    def of(cls, positions: FloatArray, cover: FloatArray) -> Limbs:
        """positions: (n, 13, 3) as in `pose_cover`; cover: (k, 38) theirs."""
        lines = [
            poses[:, SUN_ROLES.index(_R.LEFT_SHOULDER)]
            - poses[:, SUN_ROLES.index(_R.RIGHT_SHOULDER)]
            for poses in (positions.astype(np.float64), body_poses(positions))
        ]
        there, here = (line[:, 0] + 1j * line[:, 2] for line in lines)
        turns = np.nan_to_num(there / here)
        return cls(positions, turns, np.abs(turns), cover)

    def moved(self, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """The positions (n, 13, 3) and the cover (k, 38) after a random move of the limbs."""
        offsets = np.zeros((len(SUN_ROLES), 3))
        for joints in TOGETHER:
            offsets[[SUN_ROLES.index(joint) for joint in joints]] = rng.normal(scale=SPREAD, size=3)
        level = self.turns[:, None] * (offsets[:, 0] + 1j * offsets[:, 2])
        positions = self.positions.copy()
        positions[..., 0] += level.real
        positions[..., 1] += self.sizes[:, None] * offsets[:, 1]
        positions[..., 2] += level.imag
        cover = self.cover.copy()
        joints = [index for index, role in enumerate(SUN_ROLES) if role is not _R.HIPS]
        vector = (offsets[joints] / np.sqrt(len(joints))).reshape(POSE_WIDTH)
        cover[:, _FACTS:] += vector.astype(cover.dtype)
        return positions, cover
