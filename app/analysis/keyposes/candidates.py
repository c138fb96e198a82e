"""Candidates for keyposes: rests at beats, or all rests where no beat is known (Perera 3.1).

What makes a candidate a keypose, the thresholds T1 and T2, comes later: the same candidates
serve every pair of thresholds, so that these can be learned.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.analysis.keyposes.energy_minima import SURE_MINIMUM, EnergyMinimum, usual_length
from app.numerics.arrays import FloatArray

REACH = 0.35
"""How far from its beat a rest may be, in beats."""

ALMOST = 0.4
"""Of that reach: a rest that begins so little after a beat was reached on it all the same."""

MAX_BEAT_INTERVAL = 1.5
"""Median intervals: between beats further apart than that some are missing."""

LONE_BEAT = 15.0
"""Frames; taken for the interval where only one beat is given."""

ASIDE = 0.5
"""Units of energy that a rest at its beat's furthest reach must lie lower to be preferred."""

LONG = 2.5
"""Usual lengths beyond which a rest is a freeze: its moment is its arrival, not its middle."""

FIRST_POSE = 7.0
"""Frames: a clip that begins with a shorter rest just begins; a longer one is a pose."""


NUDGE = 5.0
"""Frames by which an estimated beat may move the moment of a rest from its middle."""


AGREEING = 0.85
"""Share of the sure rests that must hold a beat, for estimated beats to be believed."""


class Scope(StrEnum):
    """Which energy tells of a rest."""

    GLOBAL = "global"
    """The whole body comes to rest on the floor."""

    LOCAL = "local"
    """The body comes to rest as seen from the waist, while that is carried on."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A rest that may be a keypose: at `frame`, on `beat` (its index; None without beats)."""

    frame: int
    beat: int | None
    scope: Scope
    minimum: EnergyMinimum


def at_beats(
    minima: tuple[EnergyMinimum, ...], beats: FloatArray, scope: Scope
) -> tuple[Candidate, ...]:
    """For each of `beats` (b,), in frames, rising, at most one rest: the lowest around it.

    A rest belongs to the beat it is nearest to; of several that it lasts for to the first, on
    which it was reached, or for the first rest of a clip to the last, on which it is left. Its
    frame is the one nearest to the beat.
    """
    if not len(beats):
        return ()
    before, after = _reaches(beats)
    around: dict[int, list[tuple[float, EnergyMinimum]]] = {}
    for minimum in minima:
        early = np.maximum(beats - minimum.last, 0.0) / before
        late = np.maximum(minimum.first - beats, 0.0) / after
        aside = float((early + late).min())
        lasting = np.flatnonzero(early + late <= aside + ALMOST)
        nearest = int(lasting[-1] if minimum.at_start else lasting[0])
        aside = float((early + late)[nearest])
        if aside <= 1.0:
            around.setdefault(nearest, []).append((minimum.energy + ASIDE * aside, minimum))
    lowest = {beat: min(found, key=lambda each: each[0])[1] for beat, found in around.items()}
    return tuple(
        Candidate(
            round(float(np.clip(beats[beat], minimum.first, minimum.last))), beat, scope, minimum
        )
        for beat, minimum in sorted(lowest.items())
    )


def _reaches(beats: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(b,) frames before and after each beat that are its own."""
    if len(beats) < 2:
        alone = np.full(len(beats), REACH * LONE_BEAT)
        return alone, alone
    intervals = np.diff(beats)
    intervals = np.minimum(intervals, MAX_BEAT_INTERVAL * float(np.median(intervals)))
    before = REACH * np.concatenate([intervals[:1], intervals])
    return before, REACH * np.concatenate([intervals, intervals[-1:]])


def at_energy_minima(
    minima: tuple[EnergyMinimum, ...], beats: FloatArray, scope: Scope
) -> tuple[Candidate, ...]:
    """Every rest, at its middle, or at that of `beats` (b,), in frames, which lies within it.

    The beats are hints, as those that were estimated from the rests themselves are. A freeze
    counts when it is reached, the first pose when it is left.
    """
    usual = usual_length(minima)
    beats = beats if _agree(minima, beats) else beats[:0]
    poses = (r for r in minima if not (r.at_start and (r.at_end or r.length < FIRST_POSE)))
    return tuple(Candidate(round(_moment(r, usual, beats)), None, scope, r) for r in poses)


def _agree(minima: tuple[EnergyMinimum, ...], beats: FloatArray) -> bool:
    sure = [minimum for minimum in minima if minimum.energy < SURE_MINIMUM]
    held = sum(len(_within(minimum, beats)) > 0 for minimum in sure)
    return held >= AGREEING * len(sure)


def _within(minimum: EnergyMinimum, beats: FloatArray) -> FloatArray:
    first, stop = (
        beats.searchsorted(minimum.first - 1),
        beats.searchsorted(minimum.last + 1, "right"),
    )
    return beats[first:stop]


def _moment(minimum: EnergyMinimum, usual: float, beats: FloatArray) -> float:
    middle = _middle(minimum, usual)
    within = _within(minimum, beats).tolist()
    if not within:
        return middle
    nearest = min(within, key=lambda beat: abs(beat - middle))
    if not minimum.at_start:
        nearest = min(max(nearest, middle - NUDGE), middle + NUDGE)
    return float(min(max(nearest, minimum.first), minimum.last))


def _middle(minimum: EnergyMinimum, usual: float) -> float:
    if minimum.at_start:
        return max(minimum.last - usual / 2, 0.0)
    if minimum.at_end or minimum.length > LONG * usual:
        return min(minimum.first + usual / 2, minimum.last)
    return 0.5 * (minimum.first + minimum.last)
