"""Where in a clip a pose is taken. Neighboring frames that stay near it are one place."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray
from app.numerics.nearest import DECIMALS

SAME_PLACE = 0.05
"""Body lengths. A place extends as far as the distance exceeds that of its best frame by at most
this. Between two places the distance rises by more than this above that of both."""


class Places(StrEnum):
    """How many places of a clip may be hits."""

    BEST = "best"
    """The one where the pose is taken best."""
    ALL = "all"
    """Each: a walk takes a pose once in every cycle."""


@dataclass(frozen=True, slots=True)
class PosePlace:
    """The part of a clip around the frame whose pose is nearest.

    distance: body lengths; frame, first, last: at ANALYSIS_RATE.
    """

    distance: float
    frame: int
    first: int
    last: int

    @property
    def time(self) -> float:
        """Seconds, of the nearest pose."""
        return self.frame / ANALYSIS_RATE

    @property
    def start(self) -> float:
        """Seconds."""
        return self.first / ANALYSIS_RATE

    @property
    def end(self) -> float:
        """Seconds: where the last frame ends."""
        return (self.last + 1) / ANALYSIS_RATE


def pose_places(distances: FloatArray, places: Places) -> list[PosePlace]:
    """The places of a clip, from its frames' distances (n,), infinity for frames of no size."""
    found = np.round(np.asarray(distances, dtype=np.float64), DECIMALS)
    best = int(np.argmin(found))
    if not np.isfinite(found[best]):
        return []
    if places is Places.BEST:
        return [_place(found, best)]
    found_places: list[PosePlace] = []
    for frame in _minima(found):
        # two minima of equal depth can belong to one place
        if not found_places or frame > found_places[-1].last:
            found_places.append(_place(found, frame))
    return found_places


def _minima(distances: FloatArray) -> list[int]:
    """Rising frames of the minima that are deep enough; the lowest is always among them."""
    wall = np.max(distances[np.isfinite(distances)]) + 1.0
    walled = -np.concatenate([[wall], np.minimum(distances, wall), [wall]])
    _, found = scipy.signal.find_peaks(walled, prominence=SAME_PLACE, plateau_size=1)
    return [int(frame) for frame in found["left_edges"] - 1]


def _place(distances: FloatArray, frame: int) -> PosePlace:
    farther = np.flatnonzero(distances > distances[frame] + SAME_PLACE)
    after = int(np.searchsorted(farther, frame))
    first = int(farther[after - 1]) + 1 if after else 0
    last = int(farther[after]) - 1 if after < len(farther) else len(distances) - 1
    return PosePlace(float(distances[frame]), frame, first, last)
