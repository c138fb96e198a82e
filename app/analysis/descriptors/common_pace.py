"""A motion played at a common pace, so that its tempo does not matter.

A motion vector of it is the same for a clip and for the clip played faster or slower. The pace is
measured at the fast moments, so a crop, or a repetition, has about the pace of the whole. A
duration in common would not do: then a walk of two steps would differ from one of ten.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.active_part import FAST_QUANTILE, joint_speed
from app.motion.frame.body_frame import BodyTrack
from app.motion.skeleton.resampling import resample
from app.numerics.quantiles import quantile

COMMON_PACE = 1.0
"""Body lengths per second (1.3 m/s), the root mean square over the joints: about a walk."""

MAX_CHANGE = 5.0
"""A motion is played at most this many times as fast, or as slow: a rest stays a rest."""


def at_common_pace(track: BodyTrack) -> BodyTrack:
    """`track` played so that its fast moments have COMMON_PACE, at the same frame rate."""
    pace = float(quantile(joint_speed(track), FAST_QUANTILE))
    # the bounds of the divisor are those of the change, and exclude 0
    change = COMMON_PACE / float(np.clip(pace, COMMON_PACE / MAX_CHANGE, COMMON_PACE * MAX_CHANGE))
    change = min(change, track.frames - 1.0)  # two frames stay, without which nothing moves
    # all columns at once: (n, 39 positions, 39 local, 3 origin, 1 heading)
    numbers = [
        track.positions.reshape(track.frames, -1),
        track.local.reshape(track.frames, -1),
        track.origin,
        track.heading[:, None],
    ]
    played = resample(np.hstack(numbers), track.rate * change, track.rate)
    positions, local, origin, heading = np.split(played, (39, 78, 81), axis=1)
    return BodyTrack(
        positions=positions.reshape(-1, 13, 3),
        local=local.reshape(-1, 13, 3),
        origin=origin,
        heading=heading[:, 0],
        body_length=track.body_length,
        rate=track.rate,
    )
