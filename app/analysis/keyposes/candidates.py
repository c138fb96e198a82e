"""Candidates for keyposes: energy minima at beats, or all minima without beats (Perera 3.1).

Later, the thresholds T1 and T2 select the keyposes. The candidates do not depend on the
thresholds, so that thresholds can be learned.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.analysis.keyposes.energy_minima import CERTAIN_ENERGY, EnergyMinimum, usual_length
from app.numerics.arrays import FloatArray

MAX_BEAT_DISTANCE = 0.35
"""How far from its beat a minimum may be, in beats."""

SAME_BEAT_MARGIN = 0.4
"""A share of MAX_BEAT_DISTANCE. A minimum that begins this much later still belongs to a beat."""

MAX_BEAT_INTERVAL = 1.5
"""In median intervals. If two beats are farther apart, beats are missing between them."""

DEFAULT_BEAT_INTERVAL = 15.0
"""Frames: the interval that is assumed if only one beat is given."""

DISTANCE_PENALTY = 0.5
"""Units of energy that are added to a minimum at the largest distance from its beat."""

FREEZE_LENGTH = 2.5
"""In usual lengths. A longer minimum is a freeze: its keypose is at its start, not its middle."""

MIN_FIRST_LENGTH = 7.0
"""Frames. If a clip begins with a shorter minimum, that is no pose, but the start of the clip."""

MAX_BEAT_SHIFT = 5.0
"""Frames by which an estimated beat may move a keypose from the middle of its minimum."""

MIN_AGREEMENT = 0.85
"""The share of the certain minima that must contain a beat; else estimated beats are ignored."""


class Scope(StrEnum):
    """What makes a pose a keypose: the energy that has a minimum there, or a turning point."""

    GLOBAL = "global"
    """The global energy: the whole body comes to rest."""

    LOCAL = "local"
    """The local energy: the body comes to rest as seen from the waist, which may travel on."""

    TURN = "turn"
    """The far end of a movement that returns to the pose that it left, such as a strike."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A minimum that may be a keypose at `frame`; beat: the index of its beat, None without.

    A turning point has a minimum of one frame, with its local energy.
    """

    frame: int
    beat: int | None
    scope: Scope
    minimum: EnergyMinimum


def at_beats(
    minima: tuple[EnergyMinimum, ...], beats: FloatArray, scope: Scope
) -> tuple[Candidate, ...]:
    """For each beat at most one candidate: the lowest minimum around it.

    beats: (b,) in frames, rising. A minimum belongs to the nearest beat. If it lasts for several
    beats, it belongs to the first one, on which it is reached. But the minimum at the start of
    the clip belongs to the last one, on which it is left. The frame of a candidate is the frame
    of its minimum that is nearest to the beat.
    """
    if not len(beats):
        return ()
    before, after = _reaches(beats)
    around: dict[int, list[tuple[float, EnergyMinimum]]] = {}
    for minimum in minima:
        early = np.maximum(beats - minimum.last, 0.0) / before
        late = np.maximum(minimum.first - beats, 0.0) / after
        distance = float((early + late).min())
        lasting = np.flatnonzero(early + late <= distance + SAME_BEAT_MARGIN)
        nearest = int(lasting[-1] if minimum.at_start else lasting[0])
        distance = float((early + late)[nearest])
        if distance <= 1.0:
            around.setdefault(nearest, []).append(
                (minimum.energy + DISTANCE_PENALTY * distance, minimum)
            )
    lowest = {beat: min(found, key=lambda each: each[0])[1] for beat, found in around.items()}
    return tuple(
        Candidate(
            round(float(np.clip(beats[beat], minimum.first, minimum.last))), beat, scope, minimum
        )
        for beat, minimum in sorted(lowest.items())
    )


def _reaches(beats: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two arrays (b,): how many frames before and after each beat belong to it."""
    if len(beats) < 2:
        alone = np.full(len(beats), MAX_BEAT_DISTANCE * DEFAULT_BEAT_INTERVAL)
        return alone, alone
    intervals = np.diff(beats)
    intervals = np.minimum(intervals, MAX_BEAT_INTERVAL * float(np.median(intervals)))
    before = MAX_BEAT_DISTANCE * np.concatenate([intervals[:1], intervals])
    return before, MAX_BEAT_DISTANCE * np.concatenate([intervals, intervals[-1:]])


def at_energy_minima(
    minima: tuple[EnergyMinimum, ...], beats: FloatArray, scope: Scope
) -> tuple[Candidate, ...]:
    """A candidate for each minimum: at its middle, or at a beat within it.

    beats: (b,) in frames, rising. They are hints, because they may be estimated from the minima
    themselves. The candidate of a freeze is near its start, that of the clip's first pose near
    its end.
    """
    usual = usual_length(minima)
    beats = beats if _agree(minima, beats) else beats[:0]
    poses = (r for r in minima if not (r.at_start and (r.at_end or r.length < MIN_FIRST_LENGTH)))
    return tuple(Candidate(round(_moment(r, usual, beats)), None, scope, r) for r in poses)


def _agree(minima: tuple[EnergyMinimum, ...], beats: FloatArray) -> bool:
    certain = [minimum for minimum in minima if minimum.energy < CERTAIN_ENERGY]
    with_beat = sum(len(_within(minimum, beats)) > 0 for minimum in certain)
    return with_beat >= MIN_AGREEMENT * len(certain)


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
        nearest = min(max(nearest, middle - MAX_BEAT_SHIFT), middle + MAX_BEAT_SHIFT)
    return float(min(max(nearest, minimum.first), minimum.last))


def _middle(minimum: EnergyMinimum, usual: float) -> float:
    if minimum.at_start:
        return max(minimum.last - usual / 2, 0.0)
    if minimum.at_end or minimum.length > FREEZE_LENGTH * usual:
        return min(minimum.first + usual / 2, minimum.last)
    return 0.5 * (minimum.first + minimum.last)
