"""The offset of a recording: exact if a clue shows the beat, else with low confidence."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.rhythm.audio_offset import Offset, estimate_offset
from app.analysis.rhythm.beats import STOP_RATE, WIDTH, Stops
from app.analysis.rhythm.onsets import RATE, Onsets
from app.numerics.arrays import FloatArray

BEAT, DANCED, PLAYED = 0.5, 20.0, 30.0


def stops_at(times: FloatArray, duration: float = DANCED) -> Stops:
    grid = np.arange(int(duration * STOP_RATE) + 1) / STOP_RATE
    curve = np.exp(-0.5 * np.square((grid[:, None] - times) / WIDTH)).max(axis=1)
    return Stops(times, np.ones(len(times)), curve, duration)


def played(full: FloatArray) -> Onsets:
    """A recording in which as much begins at each moment as `full` says."""
    return Onsets(full, full, full, len(full) / RATE)


def beats(first: float, count: int) -> FloatArray:
    return first + BEAT * np.arange(count)


def found(stops: Stops, heard: FloatArray, onsets: Onsets) -> Offset:
    offset = estimate_offset(stops, heard, onsets)
    assert offset is not None
    return offset


@pytest.mark.parametrize("introduction", [1.0, 3.0, 6.0])
def test_louder_music_during_the_dance_determines_the_beat(introduction: float) -> None:
    seconds = np.arange(int(PLAYED * RATE)) / RATE
    is_danced = (seconds >= introduction) & (seconds < introduction + DANCED)
    stops = stops_at(beats(0.25, 39))
    heard = beats(0.25, 59)
    offset = found(stops, heard, played(np.where(is_danced, 1.0, 0.3)))
    assert offset.seconds == pytest.approx(-introduction, abs=0.03)
    assert offset.confidence > 0.99
    assert offset.beat == pytest.approx(BEAT)
    even = found(stops, heard, played(np.ones(len(seconds))))
    assert offset.beat_confidence > 1.3 * even.beat_confidence


def test_a_steady_beat_alone_gives_a_low_beat_confidence() -> None:
    even = played(np.ones(int(PLAYED * RATE)))
    offset = found(stops_at(beats(0.25, 39)), beats(0.35, 59), even)
    assert (offset.seconds + 0.1) % BEAT == pytest.approx(0.0, abs=0.03) or (
        offset.seconds + 0.1
    ) % BEAT == pytest.approx(BEAT, abs=0.03)
    assert offset.confidence > 0.99
    assert offset.beat_confidence < 0.3


def test_a_changing_tempo_determines_the_beat() -> None:
    steps = BEAT * np.linspace(0.8, 1.2, 70)
    heard = np.cumsum(steps)
    danced = heard[15:50] - 5.0
    offset = found(stops_at(danced), heard, played(np.ones(int((heard[-1] + 1) * RATE))))
    assert offset.seconds == pytest.approx(-5.0, abs=0.03)
    assert offset.beat_confidence > 0.9


def test_random_stops_give_no_offset() -> None:
    times = np.sort(np.random.default_rng(3).uniform(0.0, DANCED, 40))
    onsets = played(np.ones(int(PLAYED * RATE)))
    assert estimate_offset(stops_at(times), beats(0.2, 59), onsets) is None
    assert estimate_offset(stops_at(times), beats(0.2, 1), onsets) is None
    none = Stops(np.zeros(0), np.zeros(0), np.zeros(int(DANCED * STOP_RATE)), DANCED)
    assert estimate_offset(none, beats(0.2, 59), onsets) is None
