"""Keyposes: the poses at which a motion comes to rest on its beats (Perera 2009, section 3).

Around each beat the energy's minimum is a candidate; it is a keypose if it is small (T1) or
far below the maxima beside it (T2). A candidate of the global energy comes before one of the
local energy. Where the motion has no beat, or only one estimated from the motion itself,
every rest is a candidate: such a beat knows nothing that the rests do not. A walker does not
rest; where a motion goes on for long, its keyposes are the poses at which it is slowest as
seen from the waist: the feet furthest apart, at each step.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from app.analysis.energy.energy import Energies, EnergyMethod, Weights, energies
from app.analysis.keyposes.candidates import Candidate, Scope, at_beats, at_energy_minima
from app.analysis.keyposes.energy_minima import EnergyMinimum, find_energy_minima
from app.analysis.rhythm.beats import Beats, BeatSource, find_beats, given_beats
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray, IntArray

T1 = 0.25
"""A minimum is small below this share of the median local maximum."""

T2 = 0.8
"""A minimum is deep if it lies this share of the median local maximum below the maxima."""

MIN_SEPARATION = 0.2
"""Seconds between keyposes."""

GOES_ON = 2.0
"""Seconds without a keypose after which a motion is one that does not rest."""

SLOWEST = 2.4
"""Factor on T1 for what counts as slow there."""

REPEATED = 2
"""Slow poses that there must be: one alone is an accident."""

KNOWN = frozenset({BeatSource.GIVEN, BeatSource.TEMPO, BeatSource.AUDIO})
"""Sources of beats that know more than the motion: keyposes are sought on these beats alone."""

OVERLAP = 3
"""Frames by which a local rest may miss a global one and still be the same."""


@dataclass(frozen=True, slots=True)
class Keyposes:
    """Where the keyposes are and from what they were found.

    frames: (k,) at ANALYSIS_RATE, rising; times: (k,) seconds; chosen_by: (k,) which energy
    chose each; energies: the curves, (n,) each; beats: the beats used, `beats.tempo` None
    where none.
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
    """All candidates of a motion, global ones first, each of the two in order."""

    rate: float
    energies: Energies
    beats: Beats
    found: tuple[Candidate, ...] = field(repr=False)

    @property
    def on_beats(self) -> bool:
        """Whether the beats were known, so that keyposes are sought on them alone."""
        return any(candidate.beat is not None for candidate in self.found)

    def select(self, t1: float = T1, t2: float = T2) -> tuple[Candidate, ...]:
        """The keyposes under thresholds in units of each curve's median local maximum."""
        chosen: list[Candidate] = []
        for scope in Scope:
            fresh = [c for c in self.found if c.scope is scope and passes(c.minimum, t1, t2)]
            chosen += _not_there_yet(fresh, chosen)
        if not self.on_beats:
            chosen += self._where_it_goes_on(chosen, SLOWEST * t1)
        return _apart(chosen, MIN_SEPARATION * self.rate)

    def times(self, t1: float = T1, t2: float = T2) -> FloatArray:
        """(k,) seconds of the keyposes under these thresholds."""
        return np.array([candidate.frame for candidate in self.select(t1, t2)]) / self.rate

    def _where_it_goes_on(self, chosen: list[Candidate], slow: float) -> list[Candidate]:
        """The slow poses between keyposes that are further apart than GOES_ON."""
        last = len(self.energies.local_energy) - 1
        walls = [0, *sorted(c.frame for c in chosen), last]
        local = [c for c in self.found if c.scope is Scope.LOCAL and c.minimum.energy < slow]
        found: list[Candidate] = []
        for left, right in pairwise(walls):
            between = [c for c in local if left < c.frame < right]
            long = right - left >= GOES_ON * self.rate or not chosen
            found += between if long and len(between) >= REPEATED else []
        return _not_there_yet(found, chosen)


def find_keyposes(
    track: BodyTrack,
    *,
    method: EnergyMethod | str = EnergyMethod.RMS,
    weights: Weights | str = Weights.UNIFORM,
    t1: float = T1,
    t2: float = T2,
    beats: Beats | FloatArray | None = None,
    plain: Energies | None = None,
) -> Keyposes:
    """The keyposes of `track`.

    beats: as they are known, or (b,) seconds, none if there are none; None: estimated from the
    motion. t1, t2: thresholds in units of the median local maximum of each energy curve.
    plain: `energies(track)`, where they are at hand. Raises ValueError for another method or
    other weights.
    """
    method, weights = EnergyMethod(method), Weights(weights)
    candidates = find_candidates(track, method=method, weights=weights, beats=beats, plain=plain)
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
    plain: Energies | None = None,
) -> Candidates:
    """What `find_keyposes` selects from."""
    if (method, weights) == (EnergyMethod.RMS, Weights.UNIFORM):
        curves = plain = plain or energies(track)
    else:
        curves = energies(track, method, weights)
    # Beats are sought in the plain energy, whatever keyposes are sought in.
    used = _used(beats) or find_beats((plain or energies(track)).global_energy, track.rate)
    look = at_beats if are_law(used) else at_energy_minima
    found = (
        candidate
        for curve, scope in ((curves.whole, Scope.GLOBAL), (curves.own, Scope.LOCAL))
        for candidate in look(find_energy_minima(curve), used.times * track.rate, scope)
    )
    return Candidates(track.rate, curves, used, tuple(found))


def _used(beats: Beats | FloatArray | None) -> Beats | None:
    if beats is None or isinstance(beats, Beats):
        return beats
    return given_beats(np.unique(np.asarray(beats, dtype=np.float64)))


def are_law(beats: Beats) -> bool:
    """Whether keyposes are sought on these beats alone."""
    return beats.source in KNOWN and len(beats.times) > 0


def passes(minimum: EnergyMinimum, t1: float, t2: float) -> bool:
    """Whether a rest's energy is small enough, or far enough below the maxima beside it."""
    return minimum.energy < t1 or minimum.drop > t2


def _not_there_yet(fresh: list[Candidate], chosen: list[Candidate]) -> list[Candidate]:
    """Those of `fresh` whose beat, or rest where there are no beats, is not chosen yet."""
    beats = {candidate.beat for candidate in chosen} - {None}
    minima = [candidate.minimum for candidate in chosen if candidate.beat is None]
    starts = [minimum.first - OVERLAP for minimum in minima]

    def overlaps(minimum: EnergyMinimum) -> bool:
        # Rests of one curve are in order and apart: only the last that starts before can do.
        before = bisect_right(starts, minimum.last)
        return before > 0 and minima[before - 1].last + OVERLAP >= minimum.first

    return [each for each in fresh if each.beat not in beats and not overlaps(each.minimum)]


def _apart(chosen: Iterable[Candidate], least: float) -> tuple[Candidate, ...]:
    """In order, at least `least` frames apart; of those too close the one of less energy stays."""
    kept: list[Candidate] = []
    for candidate in sorted(chosen, key=lambda each: each.frame):
        if kept and candidate.frame - kept[-1].frame < least:
            kept[-1] = min(kept[-1], candidate, key=lambda each: each.minimum.energy)
        else:
            kept.append(candidate)
    return tuple(kept)
