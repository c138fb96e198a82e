"""The frames of a clip that are near a pose. Neighboring frames that stay near it are one match."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray
from app.numerics.nearest import DECIMALS

MATCH_DEPTH = 0.05
"""Body lengths. A match extends to the frames whose distance is at most this much larger than that
of its best frame. Between two matches, the distance is larger than that of both best frames by more
than this."""


class MatchesPerClip(StrEnum):
    """How many matches of a clip may be hits."""

    BEST = "best"
    """Only the match with the smallest distance."""
    ALL = "all"
    """All matches. A walk has one in each cycle."""


@dataclass(frozen=True, slots=True)
class PoseMatch:
    """The part of a clip around a frame that is near the pose.

    distance: of the nearest frame, in body lengths. frame, first, last: the nearest, the first and
    the last frame, at ANALYSIS_RATE.
    """

    distance: float
    frame: int
    first: int
    last: int

    @property
    def time(self) -> float:
        """The time of the nearest frame, in seconds."""
        return self.frame / ANALYSIS_RATE

    @property
    def start(self) -> float:
        """The time at which the first frame begins, in seconds."""
        return self.first / ANALYSIS_RATE

    @property
    def end(self) -> float:
        """The time at which the last frame ends, in seconds."""
        return (self.last + 1) / ANALYSIS_RATE


def pose_matches(distances: FloatArray, per_clip: MatchesPerClip) -> list[PoseMatch]:
    """The matches of a clip, in order of time.

    distances: (n,) of the clip's frames to the pose, in body lengths, n >= 1; infinity for frames
    of size 0. Without a finite distance the list is empty.
    """
    rounded = np.round(np.asarray(distances, dtype=np.float64), DECIMALS)
    best = int(np.argmin(rounded))
    if not np.isfinite(rounded[best]):
        return []
    if per_clip is MatchesPerClip.BEST:
        return [_match_around(rounded, best)]
    matches: list[PoseMatch] = []
    for frame in _minima(rounded):
        # two minima of equal depth can belong to one match
        if not matches or frame > matches[-1].last:
            matches.append(_match_around(rounded, frame))
    return matches


def _minima(distances: FloatArray) -> list[int]:
    """The frames, ascending, of the minima that are deeper than MATCH_DEPTH, and of the lowest."""
    # The walls make a minimum at either end a peak too. Frames of size 0 are as high as the walls.
    wall = np.max(distances[np.isfinite(distances)]) + 1.0
    walled = -np.concatenate([[wall], np.minimum(distances, wall), [wall]])
    _, peaks = scipy.signal.find_peaks(walled, prominence=MATCH_DEPTH, plateau_size=1)
    return [int(frame) for frame in peaks["left_edges"] - 1]


def _match_around(distances: FloatArray, frame: int) -> PoseMatch:
    """The match around a minimum: it ends before the next frame on either side that is too far."""
    farther = np.flatnonzero(distances > distances[frame] + MATCH_DEPTH)
    after = int(np.searchsorted(farther, frame))
    first = int(farther[after - 1]) + 1 if after else 0
    last = int(farther[after]) - 1 if after < len(farther) else len(distances) - 1
    return PoseMatch(float(distances[frame]), frame, first, last)
