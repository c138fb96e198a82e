"""The beats of a clip, from everything that is known: client, audio recording, motion.

The beats that a client lists come first. Then come the beats of the recording, at the client's
tempo if it gives one; then the client's tempo alone; then beats estimated from the motion. The
offset between recording and motion turns the beats of the recording into beats of the clip.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.energy.energy import Energies, energies
from app.analysis.rhythm.audio_beats import find_audio_beats
from app.analysis.rhythm.audio_offset import Offset, estimate_offset
from app.analysis.rhythm.beats import (
    Beats,
    BeatSource,
    beats_of_tempo,
    continued,
    find_beats,
    find_stops,
    given_beats,
    no_beats,
)
from app.analysis.rhythm.onsets import Onsets
from app.motion.frame.body_frame import BodyTrack
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray

SOURCES = tuple(BeatSource)
"""The stored array `beat_facts` refers to this order. New sources must be appended."""


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
    audio_beats, offset = no_beats(), None
    if onsets is not None:
        audio_beats = find_audio_beats(onsets, given.tempo)
        # The offset needs every beat: a given tempo may be half of that at which people stop.
        beats_at_any_tempo = (
            find_audio_beats(onsets) if given.tempo and given.audio_offset is None else audio_beats
        )
        offset = _offset(given, energy, track.rate, beats_at_any_tempo, onsets)
    shifted = None if offset is None else _shifted(audio_beats, offset, duration)
    cautions = [] if onsets is None else _cautions_of(given, audio_beats, offset, shifted)
    if given.beats and not _within(given.beats, duration):
        detail = f"None of the beats that were given lies within the {duration:.2f} s of motion."
        cautions.append(Caution("beats_outside_motion", detail))
        given = replace(given, beats=None)
    return Rhythm(_beats_by_priority(given, energy, track.rate, shifted), offset, tuple(cautions))


def _within(times: Sequence[float] | FloatArray, duration: float) -> bool:
    """Whether any of `times`, in seconds, lies within a motion of `duration` seconds."""
    return any(0.0 <= time <= duration for time in times)


def _beats_by_priority(
    given: RhythmInput, energy: FloatArray, rate: float, shifted: Beats | None
) -> Beats:
    """The beats from the best source: the client, the recording, a given tempo, the motion."""
    if given.beats:
        return given_beats(np.array(given.beats))
    if shifted is not None:
        return shifted
    if given.tempo:
        return beats_of_tempo(energy, rate, given.tempo)
    return find_beats(energy, rate)


def _offset(
    given: RhythmInput, energy: FloatArray, rate: float, audio_beats: Beats, onsets: Onsets
) -> Offset | None:
    if given.audio_offset is not None:
        return Offset(given.audio_offset, 1.0, True, 0.0, 1.0)
    return estimate_offset(find_stops(energy, rate), audio_beats.times, onsets)


def _shifted(audio_beats: Beats, offset: Offset, duration: float) -> Beats | None:
    """The beats of the recording in the time of the motion, continued evenly to both ends.

    None if the recording has fewer than two beats, or none is within the motion.
    """
    times = audio_beats.times + offset.seconds
    if len(times) < 2 or not _within(times, duration):
        return None
    is_tempo_given = audio_beats.source is BeatSource.TEMPO
    return Beats(
        continued(times, duration),
        audio_beats.tempo,
        min(audio_beats.confidence, offset.confidence),
        BeatSource.TEMPO if is_tempo_given else BeatSource.AUDIO,
    )


def _cautions_of(
    given: RhythmInput, audio_beats: Beats, offset: Offset | None, shifted: Beats | None
) -> list[Caution]:
    if not len(audio_beats.times):
        return [Caution("audio_without_beats", "No beat was heard in the recording.")]
    if offset is None:
        detail = "The motion does not show when the recording begins. Send audio_offset."
        return [Caution("audio_offset_unknown", detail)]
    if shifted is None:
        detail = "With this audio_offset, no beat of the recording falls into the motion."
        return [Caution("audio_apart", detail)]
    if not offset.is_given and given.beats is None:
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
