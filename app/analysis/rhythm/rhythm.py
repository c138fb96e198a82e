"""The beats of a clip, from everything that is known: client, audio recording, motion.

The beats that a client lists come first. Then come the beats of the recording, at the client's
tempo if it gives one; then the client's tempo alone; then beats estimated from the motion. The
offset between recording and motion turns the beats of the recording into beats of the clip. They
count only if the stops of the motion confirm their phase and level (`danced_beats`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.energy.energy import Energies, energies
from app.analysis.rhythm.audio_beats import heard_beats
from app.analysis.rhythm.audio_offset import Offset, estimate_offset
from app.analysis.rhythm.beats import (
    Beats,
    BeatSource,
    Stops,
    beats_of_tempo,
    find_beats,
    find_stops,
    given_beats,
)
from app.analysis.rhythm.danced_beats import MIN_CONFIDENCE, DancedBeats, choose_danced
from app.analysis.rhythm.onsets import Onsets
from app.motion.frame.body_frame import BodyTrack
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray

SOURCES = tuple(BeatSource)
"""The stored array `beat_facts` refers to this order. New sources must be appended."""

OFFSETS_TRIED = 4
"""The offset of a recording is estimated from this many of the likeliest beats."""


@dataclass(frozen=True, slots=True)
class RhythmInput:
    """What a client says about the rhythm of a clip; None where it says nothing.

    beats: their times, in seconds of the motion. tempo: beats per minute. audio_offset: the time
    of the motion, in seconds, at which the recording begins.
    """

    beats: tuple[float, ...] | None = None
    tempo: float | None = None
    audio_offset: float | None = None


NO_RHYTHM_INPUT = RhythmInput()

BEAT_ARRAYS = ("beat_times", "beat_facts")


@dataclass(frozen=True, slots=True)
class Rhythm:
    """The beats of a clip.

    offset: that of its recording; None without a recording, or if it is unknown. cautions: doubts
    about beats and recording.
    """

    beats: Beats
    offset: Offset | None = None
    cautions: tuple[Caution, ...] = ()


def find_rhythm(
    track: BodyTrack,
    given: RhythmInput = NO_RHYTHM_INPUT,
    onsets: Onsets | None = None,
    rms_energies: Energies | None = None,
) -> Rhythm:
    """Find the beats of `track`.

    given: what a client says about them. onsets: those of the recording, None without one.
    rms_energies: `energies(track)`, if the caller has them.
    """
    energy = (rms_energies or energies(track)).global_energy
    duration = (len(energy) - 1) / track.rate
    placed = None if onsets is None else _placed(given, find_stops(energy, track.rate), onsets)
    cautions = [] if placed is None else _cautions_of(given, placed)
    if given.beats and not _within(given.beats, duration):
        detail = f"None of the beats that were given lies within the {duration:.2f} s of motion."
        cautions.append(Caution("beats_outside_motion", detail))
        given = replace(given, beats=None)
    beats = _beats_by_priority(given, energy, track.rate, placed)
    return Rhythm(beats, None if placed is None else placed.offset, tuple(cautions))


@dataclass(frozen=True, slots=True)
class _Placed:
    """A recording beside its motion.

    is_heard: whether the recording has beats. offset: None if it is unknown. danced: the beats in
    the motion; None if none is within it, or the offset is unknown.
    """

    is_heard: bool
    offset: Offset | None = None
    danced: DancedBeats | None = None

    @property
    def confirmed(self) -> DancedBeats | None:
        """The beats whose phase and level the motion confirms, or None."""
        is_sure = self.danced is not None and self.danced.confidence >= MIN_CONFIDENCE
        return self.danced if is_sure else None


def _placed(given: RhythmInput, stops: Stops, onsets: Onsets) -> _Placed:
    heard = heard_beats(onsets, given.tempo)
    if given.audio_offset is not None:
        offset = Offset(given.audio_offset, 1.0, True, 0.0, 1.0)
        return _Placed(bool(heard), offset, choose_danced(heard, stops, offset.seconds))
    # The offset needs every beat: a given tempo may be half of that at which people stop.
    at_any_tempo = heard_beats(onsets) if given.tempo else heard
    best = _Placed(bool(heard))
    for one in at_any_tempo[:OFFSETS_TRIED]:
        estimate = estimate_offset(stops, one.beats.times, onsets)
        if estimate is not None:
            tried = _Placed(True, estimate, choose_danced(at_any_tempo, stops, estimate.seconds))
            best = max(best, tried, key=_confidence) if tried.confirmed else best
    if given.tempo and best.offset is not None:
        return replace(best, danced=choose_danced(heard, stops, best.offset.seconds))
    return best


def _confidence(placed: _Placed) -> float:
    """0..1, how certain the beats of the recording in the motion are."""
    if placed.danced is None or placed.offset is None:
        return 0.0
    return min(placed.danced.confidence, placed.offset.confidence)


def _within(times: Sequence[float] | FloatArray, duration: float) -> bool:
    """Whether any of `times`, in seconds, lies within a motion of `duration` seconds."""
    return any(0.0 <= time <= duration for time in times)


def _beats_by_priority(
    given: RhythmInput, energy: FloatArray, rate: float, placed: _Placed | None
) -> Beats:
    """The beats from the best source: the client, the recording, a given tempo, the motion."""
    if given.beats:
        return given_beats(np.array(given.beats))
    if placed is not None and placed.confirmed is not None:
        heard = placed.confirmed.heard.beats
        return replace(heard, times=placed.confirmed.times, confidence=_confidence(placed))
    if given.tempo:
        return beats_of_tempo(energy, rate, given.tempo)
    return find_beats(energy, rate)


def _cautions_of(given: RhythmInput, placed: _Placed) -> list[Caution]:
    offset = placed.offset
    if not placed.is_heard:
        return [Caution("audio_without_beats", "No beat was heard in the recording.")]
    if offset is None:
        detail = "The motion does not show when the recording begins. Send audio_offset."
        return [Caution("audio_offset_unknown", detail)]
    if placed.danced is None:
        detail = "With this audio_offset, no beat of the recording falls into the motion."
        return [Caution("audio_apart", detail)]
    if given.beats is not None:
        return []
    if placed.confirmed is None:
        detail = (
            "The stops of the motion do not confirm any beat of the recording: the likeliest one"
            f" is right with probability {placed.danced.confidence:.2f}. The recording is not used"
            " for keyposes. Check audio_offset, or send beats."
        )
        return [Caution("audio_beats_doubtful", detail)]
    if not offset.is_given:
        detail = (
            f"The recording's beginning was estimated as {offset.seconds:.2f} s. It may be wrong"
            f" by whole beats of {offset.beat:.2f} s; it is exact with probability"
            f" {offset.beat_confidence:.2f}. The beats are right in both cases. Send audio_offset"
            " to be sure."
        )
        return [Caution("audio_offset_estimated", detail, offset.seconds)]
    return []


def rhythm_arrays(rhythm: Rhythm) -> dict[str, NDArray[Any]]:
    """The arrays that are stored for a rhythm.

    beat_times: (b,) seconds. beat_facts: (3,) the index of the source in SOURCES, the tempo in
    beats per minute (0 if none), and the confidence.
    """
    beats = rhythm.beats
    values = [SOURCES.index(beats.source), beats.tempo or 0.0, beats.confidence]
    return {"beat_times": beats.times, "beat_facts": np.array(values, dtype=np.float64)}


def beats_of(arrays: dict[str, NDArray[Any]]) -> Beats:
    """The beats from the arrays of `rhythm_arrays`."""
    source, tempo, confidence = (float(fact) for fact in arrays["beat_facts"])
    return Beats(arrays["beat_times"], tempo or None, confidence, SOURCES[int(source)])
