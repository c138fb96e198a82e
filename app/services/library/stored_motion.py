"""The canonical motion of a ready clip: how it becomes stored arrays, and how it is read back."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.deadline import check
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.services.library.library import Library
from app.store.clips import arrays
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx

POSITIONS, PARENTS, JOINT_NAMES = "positions", "parents", "joint_names"


def motion_arrays(motion: Motion) -> dict[str, NDArray[Any]]:
    """The arrays to store for a motion, besides its descriptors.

    positions: (frames, joints, 3) float32, meters, Y up; parents: (joints,) int32, -1 for a root;
    joint_names: (bytes,) uint8, JSON text of a list of names.
    """
    # As bytes, since the store holds numeric arrays only.
    names = json.dumps(motion.names).encode()
    return {
        POSITIONS: motion.positions.astype(np.float32),
        PARENTS: motion.parents.astype(np.int32),
        JOINT_NAMES: np.frombuffer(names, dtype=np.uint8),
    }


def load_motion(lib: Library, clip: ClipRecord) -> Motion:
    """The motion of a ready clip, at its own frame rate."""
    with lib.store.read() as tx:
        return read_motion(tx, clip)


def read_motion(tx: Tx, clip: ClipRecord) -> Motion:
    """The same as `load_motion`, in the caller's transaction."""
    check()  # a caller that reads many motions stops here after its deadline
    positions, parents, text = (
        arrays.get_one(tx, clip.id, name) for name in (POSITIONS, PARENTS, JOINT_NAMES)
    )
    names: list[str] = json.loads(text.tobytes())
    return Motion(
        format=clip.format or "",
        names=tuple(names),
        parents=parents,
        positions=positions,
        roles={JointRole(role): names.index(joint) for role, joint in clip.roles.items()},
        missing_roles=tuple(JointRole(role) for role in clip.missing_roles),
        frame_rate=clip.frame_rate or 1.0,
        declared_frame_rate=clip.declared_frame_rate,
        metres_per_unit=clip.metres_per_unit or 1.0,
    )
