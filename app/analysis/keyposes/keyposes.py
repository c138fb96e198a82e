"""Keyposes: the poses at which a motion comes to rest on its beats (Perera 2009, section 3).

The minimum of the energy around each beat is a candidate. It is a keypose if it is small (T1) or
far below the neighboring maxima (T2). Candidates of the global energy have priority over those of
the local energy. If there are no beats, or only beats estimated from the motion itself, every
minimum is a candidate, because such beats contain no other information than the minima. A walker
does not rest. If a motion goes on for long without a keypose, its keyposes are the poses at which
it is slowest as seen from the waist: at each step, when the feet are farthest apart. Without known
beats, the far ends of movements that return to the pose they left are keyposes too, such as those
of kicks and punches (`turning_points`; not in the paper). They do not depend on T1 and T2.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from app.analysis.energy.energy import Energies, EnergyMethod, Weights, energies
from app.analysis.keyposes.candidates import Candidate, Scope, at_beats, at_energy_minima
from app.analysis.keyposes.energy_minima import (
    EnergyMinimum,
    find_energy_minima,
    median_maximum,
    turning_minimum,
)
from app.analysis.keyposes.turning_points import turning_points
from app.analysis.rhythm.beats import Beats, BeatSource, find_beats, given_beats
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray

T1 = 0.25
"""A minimum is small if it is below this share of the median local maximum."""

T2 = 0.8
"""A minimum is deep if it is lower than the neighboring maxima by this share of the median local
maximum."""

MIN_SEPARATION = 0.2
"""Seconds: the smallest time between two keyposes."""

MAX_PAUSE = 2.0
"""Seconds. After this time without a keypose, slow poses count too."""

SLOW_FACTOR = 2.4
"""Slow poses have a local energy below T1 times this factor."""

MIN_SLOW_POSES = 2
"""The fewest slow poses between two keyposes. One alone may be chance."""

INDEPENDENT_SOURCES = frozenset({BeatSource.GIVEN, BeatSource.TEMPO, BeatSource.AUDIO})
"""Sources of beats that are independent of the motion. With these, keyposes are only on beats."""

MAX_GAP = 3
"""Frames. Minima of both energies that are at most this far apart count as the same one."""


@dataclass(frozen=True, slots=True)
class Keyposes:
    """The keyposes of a motion, and how they were found.

    frames: (k,) at ANALYSIS_RATE, rising. times: (k,) seconds. chosen_by: (k,) what makes
    each a keypose. energies: both curves, (n,) each. beats: the beats that were used; their tempo
    is None if there are none. method, weights, t1, t2: the parameters of the search.
    """

    frames: IntArray
    times: FloatArray
    chosen_by: tuple[Scope, ...]
    energies: Energies
    beats: Beats
    method: EnergyMethod
    weights: Weights
    t1: float
    t2: float

    @property
    def global_energy(self) -> FloatArray:
        """(n,) body lengths per second."""
        return self.energies.global_energy

    @property
    def local_energy(self) -> FloatArray:
        """(n,) body lengths per second."""
        return self.energies.local_energy


@dataclass(frozen=True, slots=True)
class Candidates:
    """All candidates of a motion: first the global, then the local ones, each in order of time.

    rate: of their frames, Hz. poses: (n, joints, 3) as seen from the waist, in body lengths.
    """

    rate: float
    energies: Energies
    beats: Beats
    poses: FloatArray = field(repr=False)
    found: tuple[Candidate, ...] = field(repr=False)

    @property
    def on_beats(self) -> bool:
        """Whether the candidates belong to beats, because the beats were known."""
        return any(candidate.beat is not None for candidate in self.found)

    def select(self, t1: float = T1, t2: float = T2) -> tuple[Candidate, ...]:
        """The keyposes for these thresholds, in order of time.

        t1, t2: in units of the median local maximum of each energy curve.
        """
        chosen: list[Candidate] = []
        for scope in Scope:
            new = [c for c in self.found if c.scope is scope and passes(c.minimum, t1, t2)]
            chosen += _without_duplicates(new, chosen)
        if not self.on_beats:
            chosen += self._slow_poses(chosen, SLOW_FACTOR * t1)
            chosen += self._turns(chosen)
        return _apart(chosen, MIN_SEPARATION * self.rate)

    def times(self, t1: float = T1, t2: float = T2) -> FloatArray:
        """(k,) the times, in seconds, of the keyposes for these thresholds."""
        return np.array([candidate.frame for candidate in self.select(t1, t2)]) / self.rate

    def _slow_poses(self, chosen: list[Candidate], slow: float) -> list[Candidate]:
        """The slow poses between keyposes that are farther apart than MAX_PAUSE.

        slow: the largest local energy of a slow pose.
        """
        last = len(self.energies.local_energy) - 1
        bounds = [0, *sorted(c.frame for c in chosen), last]
        local = [c for c in self.found if c.scope is Scope.LOCAL and c.minimum.energy < slow]
        found: list[Candidate] = []
        for left, right in pairwise(bounds):
            between = [c for c in local if left < c.frame < right]
            long = right - left >= MAX_PAUSE * self.rate or not chosen
            found += between if long and len(between) >= MIN_SLOW_POSES else []
        return _without_duplicates(found, chosen)

    def _turns(self, chosen: list[Candidate]) -> list[Candidate]:
        """The turning points between two neighboring keyposes, or an end of the clip."""
        energy = self.energies.local_energy
        unit = max(median_maximum(energy)[0], 1e-9)
        bounds = sorted({0, *(c.frame for c in chosen), len(energy) - 1})
        return [
            Candidate(frame, None, Scope.TURN, turning_minimum(frame, float(energy[frame]) / unit))
            for frame in turning_points(self.poses, bounds)
        ]


def find_keyposes(
    track: BodyTrack,
    *,
    method: EnergyMethod | str = EnergyMethod.RMS,
    weights: Weights | str = Weights.UNIFORM,
    t1: float = T1,
    t2: float = T2,
    beats: Beats | FloatArray | None = None,
    rms_energies: Energies | None = None,
) -> Keyposes:
    """The keyposes of `track`.

    method, weights: how the energies are computed. t1, t2: thresholds in units of the median
    local maximum of each energy curve. beats: the known beats, as (b,) seconds or as `Beats`; an
    empty array says that there are none; None estimates them from the motion. rms_energies:
    `energies(track)`, if the caller has them. Raises ValueError for an unknown method or
    unknown weights.
    """
    method, weights = EnergyMethod(method), Weights(weights)
    candidates = find_candidates(
        track, method=method, weights=weights, beats=beats, rms_energies=rms_energies
    )
    chosen = candidates.select(t1, t2)
    frames = np.array([candidate.frame for candidate in chosen], dtype=np.int64)
    return Keyposes(
        frames=frames,
        times=frames / track.rate,
        chosen_by=tuple(candidate.scope for candidate in chosen),
        energies=candidates.energies,
        beats=candidates.beats,
        method=method,
        weights=weights,
        t1=t1,
        t2=t2,
    )


def find_candidates(
    track: BodyTrack,
    *,
    method: EnergyMethod = EnergyMethod.RMS,
    weights: Weights = Weights.UNIFORM,
    beats: Beats | FloatArray | None = None,
    rms_energies: Energies | None = None,
) -> Candidates:
    """The candidates from which `find_keyposes` selects; the parameters are the same."""
    if (method, weights) == (EnergyMethod.RMS, Weights.UNIFORM):
        curves = rms_energies = rms_energies or energies(track)
    else:
        curves = energies(track, method, weights)
    # Beats are always estimated from the RMS energy, whatever the method of the keyposes.
    used = _given(beats) or find_beats((rms_energies or energies(track)).global_energy, track.rate)
    find = at_beats if are_independent(used) else at_energy_minima
    found = (
        candidate
        for curve, scope in ((curves.global_curve, Scope.GLOBAL), (curves.local_curve, Scope.LOCAL))
        for candidate in find(find_energy_minima(curve), used.times * track.rate, scope)
    )
    return Candidates(track.rate, curves, used, track.local, tuple(found))


def _given(beats: Beats | FloatArray | None) -> Beats | None:
    if beats is None or isinstance(beats, Beats):
        return beats
    return given_beats(np.unique(np.asarray(beats, dtype=np.float64)))


def are_independent(beats: Beats) -> bool:
    """Whether there are beats that do not come from the motion. Then keyposes must be on beats."""
    return beats.source in INDEPENDENT_SOURCES and len(beats.times) > 0


def passes(minimum: EnergyMinimum, t1: float, t2: float) -> bool:
    """Whether the energy of a minimum is below t1, or more than t2 below the neighboring maxima."""
    return minimum.energy < t1 or minimum.drop > t2


def _without_duplicates(new: list[Candidate], chosen: list[Candidate]) -> list[Candidate]:
    """The candidates of `new` whose beat is not chosen yet, or, without beats, their minimum."""
    beats = {candidate.beat for candidate in chosen} - {None}
    minima = [candidate.minimum for candidate in chosen if candidate.beat is None]
    starts = [minimum.first - MAX_GAP for minimum in minima]

    def overlaps(minimum: EnergyMinimum) -> bool:
        # The minima of a curve are in order and do not overlap. So only the last one that
        # starts before `minimum` ends can overlap it.
        before = bisect_right(starts, minimum.last)
        return before > 0 and minima[before - 1].last + MAX_GAP >= minimum.first

    return [each for each in new if each.beat not in beats and not overlaps(each.minimum)]


def _apart(chosen: Iterable[Candidate], min_separation: float) -> tuple[Candidate, ...]:
    """The candidates in order of time, at least `min_separation` frames apart.

    Of two that are closer, the one with less energy stays.
    """
    apart: list[Candidate] = []
    for candidate in sorted(chosen, key=lambda each: each.frame):
        if apart and candidate.frame - apart[-1].frame < min_separation:
            apart[-1] = min(apart[-1], candidate, key=lambda each: each.minimum.energy)
        else:
            apart.append(candidate)
    return tuple(apart)
