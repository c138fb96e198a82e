"""Measures of a motion: a few numbers by which people filter and sort clips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.energy.energy import Energies, velocities
from app.motion.frame.body_frame import BodyTrack

SMOOTHING = 0.1
"""Seconds (standard deviation). Else the noise of markers would add to the way of the hips."""


@dataclass(frozen=True, slots=True)
class Measures:
    """The measures of a motion.

    travel: meters that the hips travel over the floor, forth and back. speed: their mean speed over
    the floor, meters per second. energy: mean energy in the world, body lengths per second (see
    `energies`). tempo: beats per minute, None without beats.
    """

    travel: float
    speed: float
    energy: float
    tempo: float | None


def measure(track: BodyTrack, energies: Energies, tempo: float | None) -> Measures:
    """The measures of `track`. energies: of the track; tempo: of its beats, None without any."""
    hips = velocities(track.origin[:, None] - track.origin[0], track.rate, SMOOTHING)[:, 0]
    speed = float(np.hypot(hips[:, 0], hips[:, 2]).mean())
    seconds = (track.frames - 1) / track.rate
    return Measures(speed * seconds, speed, float(energies.global_energy.mean()), tempo)
