"""Which of the beats that a recording may have are danced: their phase and level.

What is heard as the beat is often half or twice the beat, or the middle between two beats. Dancers
come to rest on beats (Perera 2009, section 3.1: "the local minimum around the music beat"), so the
stops of the motion decide between the beats that may be heard. A multinomial logit weighs both. Its
last alternative is that none of them is danced: the offset or the music is wrong, or the stops do
not follow the music.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.rhythm.audio_beats import HeardBeats
from app.analysis.rhythm.beat_tracking import MIN_BEATS
from app.analysis.rhythm.beats import STOP_RATE, Stops, continued
from app.numerics.arrays import FloatArray

MAX_STOP_OFFSET = 0.15
"""In beats. A stop that is at most this far from a beat is on it."""

MAX_STOPS = 24
"""More stops add no evidence: a dancer who is late once may always be late."""

WEIGHTS = (0.33, 0.97, 3.95, 2.76, 6.51)
"""Weights of the score of the heard beats; of the share of beats that have a stop; of the share of
stops that are on a beat; of the signed square of the stops' mean cosine of phase, times their
number; and of how much more stops there are on beats than between them. They come from 156
generated dances to the twelve pieces with true beats and to 42 pieces of the demo's styles, each
with the right offset and with a random one. With each style left out in turn, the choice was right
for all 72 dances to the twelve pieces."""

NO_BEATS_SCORE = 8.18
"""The score of the last alternative."""

MIN_CONFIDENCE = 0.5
"""With a lower confidence the beats of the motion alone are better."""


@dataclass(frozen=True, slots=True)
class DancedBeats:
    """The chosen beats; confidence: 0..1, the probability that phase and level are right.

    heard: as in the recording. times: (b,) seconds of the motion, continued evenly to its ends.
    """

    heard: HeardBeats
    times: FloatArray
    confidence: float


def choose_danced(heard: Sequence[HeardBeats], stops: Stops, offset: float) -> DancedBeats | None:
    """The likeliest of the heard beats; None if the motion has none of them or is too short.

    stops: those of the motion. offset: the time of the motion, in seconds, at which the recording
    begins.
    """
    possible = []
    for one in heard:
        times = one.beats.times + offset
        if ((times >= 0.0) & (times <= stops.duration)).any():
            times = continued(times, stops.duration)
            possible += [(one, times)] if len(times) >= MIN_BEATS else []
    if not possible:
        return None
    evidence = np.array([(one.score, *stop_evidence(stops, times)) for one, times in possible])
    scores = np.append(evidence @ WEIGHTS, NO_BEATS_SCORE)
    shares = np.exp(scores - scores.max())
    best = int(scores[:-1].argmax())
    return DancedBeats(*possible[best], float(shares[best] / shares.sum()))


def stop_evidence(stops: Stops, beats: FloatArray) -> tuple[float, float, float, float]:
    """How the stops of a motion speak for `beats` (b,), in seconds; see WEIGHTS."""
    if not len(stops.times):
        return (0.0, 0.0, 0.0, 0.0)
    weights, total = stops.weights, float(stops.weights.sum())
    # (stops, beats) distances in beats, then (stops,) that to the nearest beat
    off = (stops.times[:, None] - beats) / float(np.median(np.diff(beats)))
    nearest = off[np.arange(len(off)), np.abs(off).argmin(axis=1)]
    with_stop = float((weights[:, None] * (np.abs(off) < MAX_STOP_OFFSET)).max(axis=0).mean())
    on_beat = float(weights[np.abs(nearest) < MAX_STOP_OFFSET].sum()) / total
    cosine = float((weights * np.cos(2 * np.pi * nearest)).sum()) / total
    grid = np.arange(len(stops.curve)) / STOP_RATE
    between = 0.5 * (beats[1:] + beats[:-1])
    on, off_beat = (float(np.interp(at, grid, stops.curve).mean()) for at in (beats, between))
    return (
        with_stop,
        on_beat,
        0.1 * min(len(weights), MAX_STOPS) * cosine * abs(cosine),
        on - off_beat,
    )
