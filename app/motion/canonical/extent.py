"""Refuses positions that no human body can have, before anything is computed from them.

Damaged files, and files that are read in a wrong unit, have impossible positions. These would cause
infinities in descriptors that are stored as small floats, or useless hits. Each limit is much
larger than human movements. It is given both in meters and in body lengths, because a client may
give any unit. In 501 real clips, joints are at most 1.5 m from the hips, the hips move at most
.4 m in 1/30 s, and joints are at most 9 m from the origin.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from app.errors import BadContent, NotHuman
from app.kinedex_error import Place
from app.motion.frame.body_frame import ANALYSIS_RATE, body_length
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class _Limit:
    """The largest length, in meters and in body lengths. The smaller one is used."""

    meters: float
    bodies: float

    def in_meters(self, body_length: float) -> float:
        return min(self.meters, self.bodies * body_length)


MAX_REACH = _Limit(10.0, 1_000.0)
"""The largest distance from the hips to another joint of the body."""
MAX_STEP = _Limit(100.0, 1_000.0)
"""The largest distance that the hips move in 1/30 s, about 10,000 km/h. It is large because the
body jumps where a real recording was cut."""
MAX_DISTANCE = _Limit(10_000.0, 10_000.0)
"""The largest distance from the origin. Beyond it, float32 is less exact than a millimeter."""
BLOCK_FRAMES = 10_000


def check_extent(motion: Motion) -> tuple[Caution, ...]:
    """Cautions about far joints that do not belong to the body.

    Raises BadContent, with the joint and the frame, if the body itself exceeds a limit.
    """
    size = _size(motion)
    own = sorted(set(motion.roles.values()))
    max_distance, max_reach = MAX_DISTANCE.in_meters(size), MAX_REACH.in_meters(size)
    is_far = max(motion.positions.max(), -motion.positions.min()) > max_distance
    far = _first_beyond(motion.positions, max_distance, own) if is_far else None
    if far is not None:
        raise _refused(motion, far, max_distance, "from the origin")
    hips = motion.positions[:, motion.roles[JointRole.HIPS]]
    _refuse_jumps(MAX_STEP.in_meters(size), hips, motion)
    # In blocks, to avoid a copy of a long clip.
    for start in range(0, motion.frames, BLOCK_FRAMES):
        block = slice(start, start + BLOCK_FRAMES)
        away = motion.positions[block, own] - hips[block, None]
        reached = _first_beyond(away, max_reach, range(len(own)))
        if reached is not None:
            excess = _Excess(start + reached.frame, own[reached.joint], reached.meters)
            raise _refused(motion, excess, max_reach, "from the hips")
    return _other_joints_caution(max_distance, motion) if is_far else ()


def _size(motion: Motion) -> float:
    """The body length in meters; infinite for a body without size.

    The analysis refuses this body later, with a clearer message.
    """
    try:
        return body_length(motion)
    except NotHuman:
        return math.inf


@dataclass(frozen=True, slots=True)
class _Excess:
    """Where a limit is exceeded, and the length there in meters."""

    frame: int
    joint: int
    meters: float


def _first_beyond(positions: FloatArray, limit: float, joints: Iterable[int]) -> _Excess | None:
    """The first of `joints` with a coordinate beyond `limit`, in the first frame where this is so.

    positions: (frames, joints, 3). Joints are checked one by one, to avoid a copy of a long clip.
    """
    if max(positions.max(), -positions.min()) <= limit:
        return None
    for joint in joints:
        distances = np.abs(positions[:, joint]).max(axis=1)
        if distances.max() > limit:
            frame = int(np.argmax(distances > limit))
            return _Excess(frame, joint, float(distances[frame]))
    return None


def _refuse_jumps(limit: float, hips: FloatArray, motion: Motion) -> None:
    """Raise BadContent if the hips (frames, 3), in meters, move farther than `limit` in 1/30 s."""
    apart = max(1, round(motion.frame_rate / ANALYSIS_RATE))
    steps = np.linalg.norm(hips[apart:] - hips[:-apart], axis=-1)
    if steps.size and steps.max() > limit:
        frame = int(np.argmax(steps > limit))
        excess = _Excess(frame + apart, motion.roles[JointRole.HIPS], float(steps[frame]))
        where = f"from its position {apart / motion.frame_rate:.3g} s before"
        raise _refused(motion, excess, limit, where)


def _refused(motion: Motion, excess: _Excess, limit: float, where: str) -> BadContent:
    message = f"expected at most {limit:.3g} m {where}, found {excess.meters:.3g} m"
    location = f"frame {excess.frame}, joint {motion.names[excess.joint]}"
    return BadContent(
        f"No human body has this size or speed ({location}: {message}). Is the unit right?",
        places=[Place(location, message)],
    )


def _other_joints_caution(limit: float, motion: Motion) -> tuple[Caution, ...]:
    """A caution if a joint without a role is too far from the origin."""
    found = _first_beyond(motion.positions, limit, range(len(motion.names)))
    if found is None:
        return ()
    detail = (
        f"frame {found.frame}, joint {motion.names[found.joint]}: {found.meters:.3g} m from the"
        " origin; it is not a part of the body that is analyzed"
    )
    place, joint = (found.frame, found.frame + 1), motion.names[found.joint]
    return (Caution("position_suspect", detail, frames=place, joint=joint),)
