"""The beat of a motion, estimated from its energy (DESIGN 5 and 13).

Dancers come to rest on beats, so that energy has minima there. The logarithm of energy
makes the minima as strong as the maxima; its spectrum, summed over harmonics, has a peak
at the beat; half and double are then compared, since a sum over harmonics cannot tell them
apart. Where no rhythm explains the energy there are no beats.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from app.numerics.arrays import FloatArray

SLOWEST, FASTEST = 40.0, 200.0
"""Beats per minute."""

HARMONICS = 4
LEAST_BEATS = 4
"""Fewer in a clip are no rhythm."""

LEAST_CONFIDENCE = 0.35
"""Below, no beats are reported."""

TREND = 2.0
"""Seconds (standard deviation); slower changes of energy are no rhythm."""

FLOOR = 0.05
"""Of the median energy; keeps the logarithm of rest finite."""

STEP = 0.002
"""Relative step of the tempo grid."""

OCTAVE_GAIN = 0.1
"""How much more of the energy half the tempo must explain to be preferred."""

PHASES = 64


@dataclass(frozen=True, slots=True)
class Beats:
    """A steady beat: `times` (beats,) seconds; `tempo` beats per minute, None where none.

    confidence: 0..1, the share of the changes of log energy that the rhythm explains.
    """

    times: FloatArray
    tempo: float | None
    confidence: float


NO_BEATS = Beats(np.zeros(0), None, 0.0)


def find_beats(energy: FloatArray, rate: float) -> Beats:
    """The beat of an energy curve (n,) of `rate` Hz; no times where there is no rhythm."""
    slowest = max(SLOWEST / 60, LEAST_BEATS * rate / max(len(energy), 1))
    if slowest >= FASTEST / 60 or not energy.max(initial=0.0) > 0:
        return NO_BEATS
    signal = _log_energy(energy, rate)
    if not signal.any():
        return NO_BEATS
    frequencies = np.exp(np.arange(np.log(slowest), np.log(FASTEST / 60), STEP))
    best = _octave(signal, _strongest(signal, frequencies, rate), slowest, rate)
    confidence = _explained(signal, best, rate)
    if confidence < LEAST_CONFIDENCE:
        return Beats(np.zeros(0), None, confidence)
    return Beats(_beat_times(signal, best, rate), 60.0 * best, confidence)


def _log_energy(energy: FloatArray, rate: float) -> FloatArray:
    """(n,) logarithm of energy without its slow changes."""
    floor = max(FLOOR * float(np.median(energy)), 1e-6 * float(energy.max()))
    level = np.log(energy + floor)
    return np.asarray(level - gaussian_filter1d(level, TREND * rate, mode="reflect"))


def _strongest(signal: FloatArray, frequencies: FloatArray, rate: float) -> float:
    """The frequency (Hz) whose harmonics together carry most."""
    strength = np.zeros(len(frequencies))
    for harmonic in range(1, HARMONICS + 1):
        strength += _amplitudes(signal, harmonic * frequencies, rate) / np.sqrt(harmonic)
    return float(frequencies[np.argmax(strength)])


def _amplitudes(signal: FloatArray, frequencies: FloatArray, rate: float) -> FloatArray:
    times = np.arange(len(signal)) / rate
    waves = np.exp(-2j * np.pi * frequencies[:, None] * times)
    amplitudes = np.abs(waves @ (signal * np.hanning(len(signal))))
    return np.asarray(np.where(frequencies < rate / 2, amplitudes, 0.0))


def _octave(signal: FloatArray, frequency: float, slowest: float, rate: float) -> float:
    """Half or double the frequency where that tells the energy better."""
    here = _explained(signal, frequency, rate)
    half, double = frequency / 2, frequency * 2
    if half >= slowest and _explained(signal, half, rate) > here + OCTAVE_GAIN:
        return half
    if double <= FASTEST / 60 and _explained(signal, double, rate) > here - OCTAVE_GAIN:
        return double
    return frequency


def _explained(signal: FloatArray, frequency: float, rate: float) -> float:
    """Share of the variance that the harmonics of `frequency` explain, for their number."""
    angles = 2 * np.pi * frequency * np.arange(len(signal)) / rate
    orders = np.arange(1, min(HARMONICS, int(rate / 2 / frequency)) + 1)
    waves = np.hstack([np.cos(angles[:, None] * orders), np.sin(angles[:, None] * orders)])
    fitted, *_ = np.linalg.lstsq(waves, signal, rcond=None)
    left = float(np.square(signal - waves @ fitted).sum() / np.square(signal).sum())
    freedom = len(signal) - waves.shape[1]
    return float(np.clip(1.0 - left * len(signal) / max(freedom, 1), 0.0, 1.0))


def _beat_times(signal: FloatArray, frequency: float, rate: float) -> FloatArray:
    """Times of the beats, in the phase at which they meet the least energy."""
    duration = (len(signal) - 1) / rate
    grid = np.arange(len(signal)) / rate
    shifts = np.arange(PHASES) / PHASES / frequency
    levels = [
        np.interp(np.arange(shift, duration, 1 / frequency), grid, signal).mean()
        for shift in shifts
    ]
    return np.arange(shifts[int(np.argmin(levels))], duration, 1 / frequency)
