"""The stops of a motion choose phase and level of the beats that are heard."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.rhythm.audio_beats import HeardBeats
from app.analysis.rhythm.beats import STOP_RATE, WIDTH, Beats, BeatSource, Stops
from app.analysis.rhythm.danced_beats import MIN_CONFIDENCE, choose_danced, stop_evidence
from app.numerics.arrays import FloatArray

BEAT, SECONDS, OFFSET = 0.5, 20.0, -3.0


def stops_at(times: FloatArray) -> Stops:
    grid = np.arange(int(SECONDS * STOP_RATE) + 1) / STOP_RATE
    curve = np.exp(-0.5 * np.square((grid[:, None] - times) / WIDTH)).max(axis=1, initial=0.0)
    return Stops(times, np.ones(len(times)), curve, SECONDS)


def heard_at(times: FloatArray, score: float) -> HeardBeats:
    tempo = 60.0 / float(np.median(np.diff(times)))
    return HeardBeats(Beats(times, tempo, 1.0, BeatSource.AUDIO), score)


DANCED = 0.4 + BEAT * np.arange(38)
RECORDED = DANCED - OFFSET
BETWEEN = RECORDED + BEAT / 2
DOUBLE = np.sort(np.concatenate([RECORDED, BETWEEN]))
SKIPPED = DANCED[np.arange(38) % 4 != 2]


@pytest.mark.parametrize("wrong", [BETWEEN, DOUBLE, RECORDED[::2], RECORDED[::3]])
def test_beats_that_are_danced_win_against_likelier_ones(wrong: FloatArray) -> None:
    heard = [heard_at(wrong, 1.0), heard_at(RECORDED, 0.0)]
    chosen = choose_danced(heard, stops_at(SKIPPED), OFFSET)
    assert chosen is not None
    assert chosen.heard is heard[1]
    assert chosen.confidence > 0.8
    np.testing.assert_allclose(chosen.times[:38], DANCED)
    np.testing.assert_allclose(np.diff(chosen.times), BEAT)


@pytest.mark.parametrize("wrong", [BETWEEN, RECORDED + 0.3 * BEAT, 1.3 * RECORDED])
def test_beats_that_nobody_dances_have_a_low_confidence(wrong: FloatArray) -> None:
    chosen = choose_danced([heard_at(wrong, 3.0)], stops_at(SKIPPED), OFFSET)
    assert chosen is not None
    assert chosen.confidence < MIN_CONFIDENCE


def test_random_stops_confirm_no_beat() -> None:
    stops = stops_at(np.sort(np.random.default_rng(2).uniform(0.0, SECONDS, 30)))
    chosen = choose_danced([heard_at(RECORDED, 2.0), heard_at(BETWEEN, 1.0)], stops, OFFSET)
    assert chosen is not None
    assert chosen.confidence < MIN_CONFIDENCE


def test_a_motion_without_stops_or_beats_confirms_nothing() -> None:
    still = choose_danced([heard_at(RECORDED, 2.0)], stops_at(np.zeros(0)), OFFSET)
    assert still is not None
    assert still.confidence < MIN_CONFIDENCE
    assert choose_danced([heard_at(RECORDED, 2.0)], stops_at(DANCED), 1000.0) is None
    assert choose_danced([], stops_at(DANCED), OFFSET) is None


def test_the_evidence_is_that_of_its_definition() -> None:
    stops = Stops(np.array([1.0, 2.05, 2.9]), np.array([1.0, 0.5, 1.0]), np.zeros(301), 5.0)
    with_stop, on_beat, aligned, contrast = stop_evidence(stops, np.array([1.0, 2.0, 3.0, 4.0]))
    cosine = (1.0 + 0.5 * np.cos(0.1 * np.pi) + np.cos(0.2 * np.pi)) / 2.5
    assert with_stop == pytest.approx((1.0 + 0.5 + 1.0 + 0.0) / 4)
    assert on_beat == pytest.approx(1.0)
    assert aligned == pytest.approx(0.3 * cosine**2)
    assert contrast == 0.0
