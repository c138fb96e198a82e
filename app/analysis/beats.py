"""The beat of a motion, estimated from its energy (DESIGN 5 and 13).

Dancers come to rest on beats, so energy has minima there. The logarithm of energy makes
the minima as strong as the maxima; the peak of its spectrum, summed over harmonics, is the
beat or a simple ratio of it, since harmonics cannot tell those apart; the phases of the
deep minima can. Where the minima keep no common beat there is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.fft import next_fast_len, rfft, rfftfreq
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from app.numerics.arrays import FloatArray

SLOWEST, FASTEST = 40.0, 200.0
"""Beats per minute."""

HARMONICS = 4
LEAST_BEATS = 4
"""Fewer in a clip are no rhythm."""

LEAST_CONFIDENCE = 0.9
"""Below, no beats are reported."""

TREND = 2.0
"""Seconds (standard deviation); slower changes of energy are no rhythm."""

FLOOR = 0.05
"""Of the median energy; keeps the logarithm of rest finite."""

STEP = 0.002
"""Relative step of the tempo grid."""

FINENESS = 8
"""How many times longer than the signal its transform is, so that its peaks are seen."""

RATIOS = (1 / 3, 1 / 2, 2 / 3, 1.0, 3 / 2, 2.0, 3.0)
"""What the spectrum's strongest tempo may be mistaken for."""

ABOUT_AS_WELL = 0.1

REFINED = np.exp(np.arange(-0.03, 0.0305, 0.001))
"""Relative changes of tempo tried in the end."""

DEEP = 1.2
"""Prominence of the minima that count, in standard deviations of log energy."""

TEMPI = 30.0
"""Tempi that may meet the minima by accident, about; see `_confidence`."""


class BeatSource(StrEnum):
    """From what beats are known; each goes before those below it."""

    GIVEN = "given"
    """A client listed their times."""

    TEMPO = "tempo"
    """A client told the tempo; their places were sought in the recording or the motion."""

    AUDIO = "audio"
    """Found in the recording."""

    MOTION = "motion"
    """Found in the motion's energy."""

    NONE = "none"
    """No beats were found, which is an answer."""


@dataclass(frozen=True, slots=True)
class Beats:
    """Beats of a clip: `times` (beats,) seconds; `tempo` beats per minute, None where none.

    confidence: 0..1, how surely they are no accident.
    """

    times: FloatArray
    tempo: float | None
    confidence: float
    source: BeatSource = BeatSource.MOTION


def no_beats(confidence: float = 0.0) -> Beats:
    """None, with the `confidence` of the best there would have been."""
    return Beats(np.zeros(0), None, confidence, BeatSource.NONE)


def given_beats(times: FloatArray) -> Beats:
    """Beats that somebody lists: (beats,) seconds, rising."""
    steps = np.diff(times)
    tempo = float(60.0 / np.median(steps)) if len(steps) else None
    return Beats(np.asarray(times, dtype=np.float64), tempo, 1.0, BeatSource.GIVEN)


def find_beats(energy: FloatArray, rate: float) -> Beats:
    """The beat of an energy curve (n,) of `rate` Hz; no times where there is no rhythm."""
    slowest = max(SLOWEST / 60, LEAST_BEATS * rate / max(len(energy), 1))
    signal = _log_energy(energy, rate)
    minima = _deep_minima(signal) / rate
    if slowest >= FASTEST / 60 or len(minima) < LEAST_BEATS:
        return no_beats()
    frequency = _on_minima(minima, _strongest(signal, slowest, rate), slowest)
    confidence = _confidence(minima, frequency)
    if confidence < LEAST_CONFIDENCE:
        return no_beats(confidence)
    times = _beat_times(minima, frequency, (len(energy) - 1) / rate)
    return Beats(times, 60.0 * frequency, confidence)


def _log_energy(energy: FloatArray, rate: float) -> FloatArray:
    """(n,) logarithm of energy without its slow changes; zeros for what does not move."""
    highest = float(energy.max(initial=0.0))
    if not highest > 0:
        return np.zeros(len(energy))
    level = np.log(energy + max(FLOOR * float(np.median(energy)), 1e-6 * highest))
    return np.asarray(level - gaussian_filter1d(level, TREND * rate, mode="reflect"))


def _deep_minima(signal: FloatArray) -> FloatArray:
    if not signal.any():
        return np.zeros(0)
    minima, _ = find_peaks(-signal, prominence=DEEP * float(signal.std()))
    return np.asarray(minima, dtype=np.float64)


def _strongest(signal: FloatArray, slowest: float, rate: float) -> float:
    """The frequency (Hz) whose harmonics together carry most."""
    frequencies = np.exp(np.arange(np.log(slowest), np.log(FASTEST / 60), STEP))
    strength = np.zeros(len(frequencies))
    for harmonic in range(1, HARMONICS + 1):
        strength += _amplitudes(signal, harmonic * frequencies, rate) / np.sqrt(harmonic)
    return float(frequencies[np.argmax(strength)])


def _amplitudes(signal: FloatArray, frequencies: FloatArray, rate: float) -> FloatArray:
    """(frequencies,) of a Hann-windowed `signal` (n,), 0 from half its `rate` on."""
    length = next_fast_len(FINENESS * len(signal), real=True)
    spectrum = np.abs(rfft(signal * np.hanning(len(signal)), length))
    return np.asarray(np.interp(frequencies, rfftfreq(length, 1 / rate), spectrum, right=0.0))


def _on_minima(minima: FloatArray, frequency: float, slowest: float) -> float:
    """The simple ratio of `frequency`, and what is close to it, that the minima keep best.

    Of those kept about as well it is the slowest: each beat of a tempo is one of its double.
    """
    near = [frequency * ratio for ratio in RATIOS]
    kept = {f: _common_phase(minima, f) for f in near if slowest <= f <= FASTEST / 60}
    best = min(f for f, phase in kept.items() if phase >= max(kept.values()) - ABOUT_AS_WELL)
    return float(max(best * REFINED, key=lambda f: _common_phase(minima, f)))


def _common_phase(times: FloatArray, frequency: float) -> float:
    """Length of the mean phase vector of `times` (k,): 1 if all are on one beat."""
    return float(np.abs(np.exp(2j * np.pi * frequency * times).mean()))


def _confidence(minima: FloatArray, frequency: float) -> float:
    """Rayleigh's test: k times at random meet a beat as well with probability exp(-k R^2)."""
    chance = np.exp(-len(minima) * _common_phase(minima, frequency) ** 2)
    return float(np.clip(1.0 - TEMPI * chance, 0.0, 1.0))


def _beat_times(minima: FloatArray, frequency: float, duration: float) -> FloatArray:
    """Times of the beats within the clip, in the phase of the minima."""
    angle = np.angle(np.exp(2j * np.pi * frequency * minima).mean()) / (2 * np.pi)
    return np.asarray(np.arange((angle % 1.0) / frequency, duration, 1.0 / frequency))
