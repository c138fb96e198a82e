"""Adds joints to a recording for roles that have no joint of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray


def with_joints(
    recording: Recording, tracks: Mapping[JointRole, FloatArray], how: str
) -> tuple[Recording, dict[JointRole, int]]:
    """The recording with one more joint, a root, for each role, and these joints.

    tracks: (frames, 3) the positions of each joint. how: the first word of the joints' names. The
    rotations of a file have no joint for them, so they are left out.
    """
    if not tracks:
        return recording, {}
    old = recording.skeleton
    more = np.stack(list(tracks.values()), axis=1)
    positions = np.concatenate([recording.positions, more.astype(np.float32)], axis=1)
    names = [_free_name(f"{how}_{role.value}", old.names) for role in tracks]
    skeleton = Skeleton(
        names=(*old.names, *names),
        parents=np.concatenate([old.parents, np.full(len(tracks), -1)]),
        offsets=np.concatenate([old.offsets, positions[0, len(old) :].astype(np.float64)]),
        end_parents=old.end_parents,
        end_offsets=old.end_offsets,
    )
    made = replace(
        recording, skeleton=skeleton, positions=positions, rotations=None, translations=None
    )
    return made, {role: len(old) + index for index, role in enumerate(tracks)}


def _free_name(name: str, names: Sequence[str]) -> str:
    """A name that no joint has: "middle_hips"."""
    while name in names:
        name += "_"
    return name
