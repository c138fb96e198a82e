"""Keyposes by the speed of hands and feet: what Perera compares with (2009, sections 3.1, 3.2).

After Shiratori et al. 2004, as Perera tells it: the speed of the end effectors, and the
beat. A beat at which the hands come to rest while the feet rest too is a keypose. Hands are
seen from the waist, feet from the floor; feet that never move are at rest always. It stands
beside the energies, to be measured, and is no default.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.energy.energy import SMOOTHING, EnergyCurve, velocities
from app.analysis.keyposes.candidates import Candidate, Scope, at_beats, at_energy_minima
from app.analysis.keyposes.energy_minima import EnergyMinimum, find_energy_minima
from app.analysis.keyposes.keyposes import MIN_SEPARATION, T1, T2, are_law, passes
from app.analysis.rhythm.beats import Beats
from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

HANDS = [SUN_ROLES.index(role) for role in (JointRole.LEFT_HAND, JointRole.RIGHT_HAND)]
FEET = [SUN_ROLES.index(role) for role in (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT)]

TOGETHER = 6.0
"""Frames by which the rests of hands and feet may miss each other."""


@dataclass(frozen=True, slots=True)
class EndEffectorCandidates:
    """moments: rests of the hands, on beats where there are any; standing: rests of the feet."""

    rate: float
    moments: tuple[Candidate, ...]
    standing: tuple[EnergyMinimum, ...]

    def times(self, t1: float = T1, t2: float = T2) -> FloatArray:
        """(k,) seconds of the keyposes, rising.

        t1, t2: in units of the median local maximum of each speed, as for the energies.
        """
        planted = [minimum for minimum in self.standing if passes(minimum, t1, t2)]
        frames = [
            moment.frame
            for moment in self.moments
            if passes(moment.minimum, t1, t2)
            and (not self.standing or any(_holds(minimum, moment.frame) for minimum in planted))
        ]
        return _apart(frames, MIN_SEPARATION * self.rate) / self.rate


def end_effector_candidates(track: BodyTrack, beats: Beats | None) -> EndEffectorCandidates:
    """What the method selects from. beats: where they are known; else rests alone count."""
    hands, feet = end_effector_speeds(track)
    times = np.zeros(0) if beats is None else beats.times * track.rate
    look = at_beats if beats is not None and are_law(beats) else at_energy_minima
    moments = look(find_energy_minima(hands), times, Scope.LOCAL)
    return EndEffectorCandidates(track.rate, moments, find_energy_minima(feet))


def end_effector_speeds(track: BodyTrack) -> tuple[EnergyCurve, EnergyCurve]:
    """Mean speed of both hands in the body frame, and of both feet in the world.

    Body lengths per second; smoothed lightly, nothing taken off.
    """
    world = (track.positions - track.origin[:1, None]) / track.body_length
    return _speed(track.local[:, HANDS], track.rate), _speed(world[:, FEET], track.rate)


def _speed(positions: FloatArray, rate: float) -> EnergyCurve:
    speeds = np.linalg.norm(velocities(positions, rate, SMOOTHING), axis=-1)
    return EnergyCurve(speeds.mean(axis=1), 0.0, SMOOTHING)


def _holds(minimum: EnergyMinimum, frame: int) -> bool:
    return minimum.first - TOGETHER <= frame <= minimum.last + TOGETHER


def _apart(frames: list[int], least: float) -> IntArray:
    kept: list[int] = []
    for frame in sorted(frames):
        if not kept or frame - kept[-1] >= least:
            kept.append(frame)
    return np.array(kept, dtype=np.int64)
