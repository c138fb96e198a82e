"""Refuses positions that no human body can have, before anything is computed from them.

Damaged files, and files read in a wrong unit, hold impossible positions. They would cause
infinities in descriptors of small floats, or useless hits. Each limit is far beyond what people
do. It is given both in meters and in lengths of the body, because a client may give any unit. In
501 real clips, joints are at most 1.5 m from the hips, the hips move at most .4 m in 1/30 s, and
joints are at most 9 m from the origin.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from app.errors import BadContent, NotHuman, Place
from app.motion.frame.body_frame import ANALYSIS_RATE, body_length
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class _Limit:
    """The largest length, in meters and in lengths of the body; the smaller one counts."""

    meters: float
    bodies: float

    def of(self, body: float) -> float:
        return min(self.meters, self.bodies * body)


REACH = _Limit(10.0, 1_000.0)
"""From the hips to another joint of the body."""
STEP = _Limit(100.0, 1_000.0)
"""Of the hips in 1/30 s, some 10,000 km/h; real recordings are cut, and then the body jumps."""
FARTHEST = _Limit(10_000.0, 10_000.0)
"""From the origin; beyond, float32 does not hold a millimeter."""


def check_extent(motion: Motion) -> tuple[Caution, ...]:
    """Cautions about far joints that do not belong to the body.

    Raises BadContent, with the joint and the frame, if the body itself exceeds a limit.
    """
    size = _size(motion)
    own = sorted(set(motion.roles.values()))
    farthest = FARTHEST.of(size)
    far = _first_beyond(motion.positions, farthest, own)
    if far is not None:
        raise _refused(motion, far, farthest, "from the origin")
    hips = motion.positions[:, motion.roles[JointRole.HIPS]]
    _refuse_jumps(STEP.of(size), hips, motion)
    for joint in own:
        away = motion.positions[:, [joint]] - hips[:, None]
        reached = _first_beyond(away, REACH.of(size), [0])
        if reached is not None:
            found = _Found(reached.frame, joint, reached.meters)
            raise _refused(motion, found, REACH.of(size), "from the hips")
    return _strangers(farthest, motion)


def _size(motion: Motion) -> float:
    """The body length in meters; infinite for a body without size, which the analysis refuses."""
    try:
        return body_length(motion)
    except NotHuman:
        return math.inf


@dataclass(frozen=True, slots=True)
class _Found:
    """Where a limit is exceeded, and the length there in meters."""

    frame: int
    joint: int
    meters: float


def _first_beyond(positions: FloatArray, limit: float, joints: Iterable[int]) -> _Found | None:
    """The first of `joints` with a coordinate beyond `limit`, and its first such frame.

    positions: (frames, joints, 3). Joints are checked one by one, to avoid a copy of a long clip.
    """
    if max(positions.max(), -positions.min()) <= limit:
        return None
    for joint in joints:
        distances = np.abs(positions[:, joint]).max(axis=1)
        if distances.max() > limit:
            frame = int(np.argmax(distances > limit))
            return _Found(frame, joint, float(distances[frame]))
    return None


def _refuse_jumps(limit: float, hips: FloatArray, motion: Motion) -> None:
    """hips: (frames, 3), meters."""
    apart = max(1, round(motion.frame_rate / ANALYSIS_RATE))
    steps = np.linalg.norm(hips[apart:] - hips[:-apart], axis=-1)
    if steps.size and steps.max() > limit:
        frame = int(np.argmax(steps > limit))
        found = _Found(frame + apart, motion.roles[JointRole.HIPS], float(steps[frame]))
        where = f"from where it was {apart / motion.frame_rate:.3g} s before"
        raise _refused(motion, found, limit, where)


def _refused(motion: Motion, found: _Found, limit: float, where: str) -> BadContent:
    message = f"expected at most {limit:.3g} m {where}, found {found.meters:.3g} m"
    location = f"frame {found.frame}, joint {motion.names[found.joint]}"
    return BadContent(
        f"No body reaches so far ({location}: {message}). Is the unit right?",
        places=[Place(location, message)],
    )


def _strangers(limit: float, motion: Motion) -> tuple[Caution, ...]:
    found = _first_beyond(motion.positions, limit, range(len(motion.names)))
    if found is None:
        return ()
    detail = (
        f"frame {found.frame}, joint {motion.names[found.joint]}: {found.meters:.3g} m from the"
        " origin; it is not a part of the body that is analyzed"
    )
    return (Caution("position_suspect", detail),)
