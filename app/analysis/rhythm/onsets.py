"""Onsets of a recording: how much new sound begins at each moment.

This is the spectral flux of Bock & Widmer 2013 ("Maximum filter vibrato suppression for onset
detection"): the rise of the level in narrow bands. Each band is compared with the loudest of its
neighbors a moment before, so that a gliding tone is no onset. librosa's `onset_strength` computes
the same. It is not used, because librosa compiles for 20 s and more at its first use, in every
analysis process if its cache is not writable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import FloatArray

RATE = 100.0
"""Hz: the rate of all curves here."""

WINDOW = 0.046
"""Seconds of sound in one spectrum."""

BANDS = 60
MIN_FREQUENCY, MAX_FREQUENCY = 30.0, 10_000.0
"""Hz: the range of the BANDS, which are evenly spaced in mel."""

COMPARED_FRAMES = 2
"""The level of a band is compared with the level this many frames earlier."""

SILENCE_LEVEL = 60.0
"""dB below the loudest moment. Everything quieter counts as silence."""

BAND_WEIGHTS: tuple[tuple[float, float], ...] = ((200.0, 1.5), (2000.0, 1.0), (np.inf, 0.6))
"""The upper edge in Hz and the weight of each part. Drums and bass mark beats; cymbals also sound
between them."""

MIN_RISE = 5.0
"""dB, weighted. If the 98th percentile of the rise is lower, the recording has no onsets. Held
chords and humming machines stay below it."""

MEAN_SECONDS = 1.0
"""Seconds over which the mean is taken that is subtracted from the strength."""

FRAMES_AT_ONCE = 512
"""Spectra that are computed at once. It bounds the memory."""


@dataclass(frozen=True, slots=True)
class Onsets:
    """Curves at RATE of a recording of `duration` seconds; frame i is at i / RATE seconds.

    strength: (n,) the onset strength of all bands above its local mean, in units of its standard
    deviation, 0 or more. rise: (n,) the rise of the amplitude, linear. bass: (n,) the same below
    200 Hz. loudness: (n,) the amplitude. All are 0 if the recording is silent.
    """

    strength: FloatArray
    rise: FloatArray
    bass: FloatArray
    loudness: FloatArray
    duration: float


def find_onsets(samples: FloatArray, rate: float) -> Onsets:
    """The onsets of a mono recording; samples: (samples,) at `rate` Hz."""
    centers, power = _band_power(samples, rate)
    loudest, bass = float(power.max(initial=0.0)), centers < BAND_WEIGHTS[0][0]
    curves = np.zeros((4, len(power)))
    for first in range(0, len(power), FRAMES_AT_ONCE):
        start = max(0, first - COMPARED_FRAMES)
        some = power[start : first + FRAMES_AT_ONCE].astype(np.float64)
        rise = _rise(np.sqrt(some))
        found = [_flux(some, loudest) @ _weights(centers), rise.sum(axis=1)]
        found += [rise[:, bass].sum(axis=1), np.sqrt(some.sum(axis=1))]
        curves[:, first : first + FRAMES_AT_ONCE] = np.array(found)[:, first - start :]
    flux, rise, low, loudness = curves
    return Onsets(_levelled(flux), rise, low, loudness, len(samples) / rate)


def _band_power(samples: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """The centers (BANDS,) of the bands in Hz, and the power (frames, BANDS) float32 in them."""
    width = int(2 ** round(np.log2(max(WINDOW * rate, 16.0))))
    centers, bank = _filters(rate, width)
    frames = int(len(samples) * RATE / rate) + 1
    padded = np.pad(samples, (width // 2, width))
    starts = np.round(np.arange(frames) * rate / RATE).astype(np.int64)
    window, power = np.hanning(width), np.empty((frames, BANDS), dtype=np.float32)
    for first in range(0, frames, FRAMES_AT_ONCE):
        some = slice(first, first + FRAMES_AT_ONCE)
        pieces = padded[starts[some, None] + np.arange(width)] * window
        power[some] = np.square(np.abs(np.fft.rfft(pieces, axis=1))) @ bank.T
    return centers, power


def _filters(rate: float, width: int) -> tuple[FloatArray, FloatArray]:
    """The centers (BANDS,) of the bands in Hz, and their triangular filters.

    The filters are (BANDS, width // 2 + 1): the weights of the lines of a spectrum of `width`
    samples at `rate` Hz.
    """
    lines = np.fft.rfftfreq(width, 1.0 / rate)
    edges = _hertz(
        np.linspace(_mel(MIN_FREQUENCY), _mel(min(MAX_FREQUENCY, 0.475 * rate)), BANDS + 2)
    )
    # A low band can be narrower than the distance of two lines. Each band gets at least one line.
    half = np.maximum(np.diff(edges), lines[1])
    up = (lines - edges[:-2, None]) / half[:-1, None]
    down = (edges[2:, None] - lines) / half[1:, None]
    bank = np.maximum(np.minimum(up, down), 0.0)
    nearest = np.abs(lines - edges[1:-1, None]).argmin(axis=1)
    bank[np.arange(BANDS), nearest] = np.maximum(bank[np.arange(BANDS), nearest], 1e-3)
    return edges[1:-1], np.asarray(bank / bank.sum(axis=1, keepdims=True), dtype=np.float64)


def _mel(hertz: float) -> float:
    return float(2595.0 * np.log10(1.0 + hertz / 700.0))


def _hertz(mel: FloatArray) -> FloatArray:
    return np.asarray(700.0 * (np.power(10.0, mel / 2595.0) - 1.0), dtype=np.float64)


def _rise(level: FloatArray) -> FloatArray:
    """(frames, BANDS) the rise of `level` in COMPARED_FRAMES frames; 0 in the first frames."""
    rise = np.zeros_like(level)
    rise[COMPARED_FRAMES:] = np.maximum(level[COMPARED_FRAMES:] - level[:-COMPARED_FRAMES], 0.0)
    return rise


def _flux(power: FloatArray, loudest: float) -> FloatArray:
    """(frames, BANDS) the rise, in dB, above the loudest neighboring band a moment before."""
    flux: FloatArray = np.zeros_like(power)
    if loudest > 0:
        level = 10.0 * np.log10(np.maximum(power / loudest, 10.0 ** (-SILENCE_LEVEL / 10.0)))
        earlier = scipy.ndimage.maximum_filter1d(level, 3, axis=1)
        flux[COMPARED_FRAMES:] = np.maximum(
            level[COMPARED_FRAMES:] - earlier[:-COMPARED_FRAMES], 0.0
        )
    return flux


def _weights(centers: FloatArray) -> FloatArray:
    """(BANDS,) weights such that the bands of each of BAND_WEIGHTS together have its weight."""
    part = np.searchsorted([upper for upper, _ in BAND_WEIGHTS], centers, side="right")
    counts = np.bincount(part, minlength=len(BAND_WEIGHTS))
    return np.array([BAND_WEIGHTS[index][1] / counts[index] for index in part])


def _levelled(curve: FloatArray) -> FloatArray:
    """(n,) `curve` above its local mean, in units of its spread; 0 if there are no onsets."""
    if len(curve) < RATE or float(np.percentile(curve, 98)) < MIN_RISE:
        return np.zeros(len(curve))
    smooth = scipy.ndimage.gaussian_filter1d(curve, 1.0)
    above = np.maximum(
        smooth - scipy.ndimage.uniform_filter1d(smooth, round(MEAN_SECONDS * RATE)), 0.0
    )
    return np.asarray(above / max(float(above.std()), 1e-9))
