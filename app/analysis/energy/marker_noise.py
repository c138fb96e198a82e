"""How much the joints of a recording shake, judged from the recording itself.

Between 8 and 12 Hz people hardly move, least of all while they rest, and no low-pass before
has taken anything away (`resampling` is flat to about 12 Hz of 30): what is there at the
quietest moments is noise. Taken to be white, it tells what noise makes of any speed.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy

from app.numerics.arrays import FloatArray

BAND = (8 / 15, 12 / 15)
"""Of half the frame rate: 8 to 12 Hz at 30."""

TAPS = 25
"""Frames that the filter sees: long enough to shut out movement, short enough to fit a rest."""

MIN_FRAMES = 2 * TAPS
"""Shorter clips show no quiet moments; their noise counts as none."""

QUIET = 0.2
"""Quantile over time of what is told as quiet, averaged over `AROUND` frames."""

AROUND = 5

QUIET_PER_MEAN = 0.84
"""That quantile as a share of the mean, for white noise on 13 joints."""


@cache
def _band_pass() -> FloatArray:
    """(TAPS,) the filter; made by the first call, because scipy.signal is slow to import."""
    taps = scipy.signal.firwin(TAPS, BAND, pass_zero=False, window="blackman")
    return np.asarray(taps - taps.mean())  # nothing at all of what stands still


def noise_power(positions: FloatArray, weights: FloatArray) -> float:
    """Weighted mean over joints of the variance of white noise, x, y and z together.

    positions: (n, joints, 3); weights: (joints,), sum 1. In squared units of `positions`;
    0 for fewer than MIN_FRAMES frames.
    """
    if len(positions) < MIN_FRAMES:
        return 0.0
    reach = TAPS // 2
    band_pass = _band_pass()
    shaking = scipy.ndimage.convolve1d(positions, band_pass, axis=0)[reach:-reach]
    power = np.square(shaking).sum(axis=-1) @ weights
    around = scipy.ndimage.convolve1d(power, np.full(AROUND, 1 / AROUND))
    gain = float(np.square(band_pass).sum())
    return float(np.quantile(around, QUIET) / (gain * QUIET_PER_MEAN))


def noise_of_speed(spread: float) -> float:
    """What white noise of variance 1 adds to a squared speed (frames^-2).

    For central differences of positions smoothed by a Gaussian of `spread` frames.
    """
    turns = np.linspace(0.0, np.pi, 513)
    return float(np.mean(np.square(np.sin(turns)) * np.exp(-np.square(spread * turns))))
