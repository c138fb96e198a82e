"""The active part of a motion: from the first movement to the last.

Many recordings begin and end with a person who stands and waits. For how long says nothing about
the motion, so descriptors of a whole clip are computed from its active part. Windows, segments and
keyposes, which have a place in time, are found in the whole clip.
"""

from __future__ import annotations

import numpy as np

from app.analysis.energy.energy import velocities
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray
from app.numerics.quantiles import quantile

MAX_IDLE_SPEED = 0.1
"""Body lengths per second (13 cm/s), the root mean square over the joints. People who stand sway
more slowly."""

MAX_IDLE_SHARE = 0.1
"""The largest idle speed as a share of the speeds of the clip's fast moments (FAST_QUANTILE)."""

FAST_QUANTILE = 0.9

SMOOTHING = 2 / 30
"""Seconds (standard deviation) by which positions are smoothed before the speed is measured."""

MARGIN = 0.2
"""Seconds that are kept before the first movement and after the last."""

MIN_SECONDS = 0.5
"""If less would be left, the motion is a rest, and all of it counts as active."""


def active_span(track: BodyTrack) -> tuple[int, int]:
    """The first frame of the active part of `track`, and the frame after its last."""
    speed = joint_speed(track)
    limit = max(MAX_IDLE_SPEED, MAX_IDLE_SHARE * float(quantile(speed, FAST_QUANTILE)))
    moving = np.flatnonzero(speed > limit)
    if not len(moving):
        return 0, track.frames
    margin = round(MARGIN * track.rate)
    first = max(0, int(moving[0]) - margin)
    stop = min(track.frames, int(moving[-1]) + 1 + margin)
    return (first, stop) if stop - first >= MIN_SECONDS * track.rate else (0, track.frames)


def active_part(track: BodyTrack) -> BodyTrack:
    """The active part of `track`."""
    return track.part(*active_span(track))


def joint_speed(track: BodyTrack) -> FloatArray:
    """(n,) the root mean square of the joints' speeds in the world, body lengths per second."""
    world = (track.positions - track.origin[:1, None]) / track.body_length
    moves = velocities(world, track.rate, SMOOTHING)
    return np.asarray(np.sqrt(np.square(moves).sum(axis=-1).mean(axis=-1)))
