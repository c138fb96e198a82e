"""Keyposes by the speed of hands and feet: the method that Perera compares with (2009, 3.1, 3.2).

It is the method of Shiratori et al. 2004, as Perera describes it. A beat at which the hands come to
rest while the feet rest too is a keypose. The speed of the hands is that in the body frame, the
speed of the feet that in the world. Feet that never move are always at rest. The benches compare
this method with the energies; the analysis does not use it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.energy.energy import MIN_SMOOTHING, EnergyCurve, velocities
from app.analysis.keyposes.candidates import Candidate, Scope, at_beats, at_energy_minima
from app.analysis.keyposes.energy_minima import EnergyMinimum, find_energy_minima
from app.analysis.keyposes.keyposes import MIN_SEPARATION, T1, T2, are_independent, passes
from app.analysis.rhythm.beats import Beats
from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

HANDS = [SUN_ROLES.index(role) for role in (JointRole.LEFT_HAND, JointRole.RIGHT_HAND)]
FEET = [SUN_ROLES.index(role) for role in (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT)]

MAX_FRAMES_APART = 6.0
"""Frames by which the minima of hands and feet may be apart."""


@dataclass(frozen=True, slots=True)
class EndEffectorCandidates:
    """The candidates of this method.

    rate: frames per second. moments: minima of the hands' speed, on beats if there are any.
    standing: minima of the feet's speed.
    """

    rate: float
    moments: tuple[Candidate, ...]
    standing: tuple[EnergyMinimum, ...]

    def times(self, t1: float = T1, t2: float = T2) -> FloatArray:
        """(k,) the times of the keyposes in seconds, rising.

        t1, t2: in units of the median local maximum of each speed, as for the energies.
        """
        planted = [minimum for minimum in self.standing if passes(minimum, t1, t2)]
        frames = [
            moment.frame
            for moment in self.moments
            if passes(moment.minimum, t1, t2)
            and (
                not self.standing or any(_is_standing(minimum, moment.frame) for minimum in planted)
            )
        ]
        return _apart(frames, MIN_SEPARATION * self.rate) / self.rate


def end_effector_candidates(track: BodyTrack, beats: Beats | None) -> EndEffectorCandidates:
    """The candidates of `track`. beats: the known beats; None if there are none."""
    hands, feet = end_effector_speeds(track)
    times = np.zeros(0) if beats is None else beats.times * track.rate
    find = at_beats if beats is not None and are_independent(beats) else at_energy_minima
    moments = find(find_energy_minima(hands), times, Scope.LOCAL)
    return EndEffectorCandidates(track.rate, moments, find_energy_minima(feet))


def end_effector_speeds(track: BodyTrack) -> tuple[EnergyCurve, EnergyCurve]:
    """The mean speed of both hands in the body frame, and of both feet in the world.

    Both are in body lengths per second, of lightly smoothed positions. No noise is subtracted.
    """
    world = (track.positions - track.origin[:1, None]) / track.body_length
    return _speed(track.local[:, HANDS], track.rate), _speed(world[:, FEET], track.rate)


def _speed(positions: FloatArray, rate: float) -> EnergyCurve:
    speeds = np.linalg.norm(velocities(positions, rate, MIN_SMOOTHING), axis=-1)
    return EnergyCurve(speeds.mean(axis=1), 0.0, MIN_SMOOTHING)


def _is_standing(minimum: EnergyMinimum, frame: int) -> bool:
    return minimum.first - MAX_FRAMES_APART <= frame <= minimum.last + MAX_FRAMES_APART


def _apart(frames: list[int], min_separation: float) -> IntArray:
    selected: list[int] = []
    for frame in sorted(frames):
        if not selected or frame - selected[-1] >= min_separation:
            selected.append(frame)
    return np.array(selected, dtype=np.int64)
