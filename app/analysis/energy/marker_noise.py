"""The noise of a recording's joints, estimated from the recording itself.

People hardly move at 8 to 12 Hz, least of all while they rest. Resampling does not remove these
frequencies (it is flat to about 12 Hz at 30 frames per second). So the signal in this band at the
quietest moments is noise. If it is white, the noise of a speed follows from it.
"""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
import scipy

from app.numerics.arrays import FloatArray
from app.numerics.quantiles import quantile

NOISE_BAND = (8 / 15, 12 / 15)
"""As shares of half the frame rate: 8 to 12 Hz at 30 frames per second."""

FILTER_FRAMES = 25
"""Length of the filter in frames: long enough to exclude movement, shorter than a usual rest."""

MIN_FRAMES = 2 * FILTER_FRAMES
"""The fewest frames. Shorter clips have no quiet moments; their noise counts as 0."""

QUIET_QUANTILE = 0.2
"""The quantile over time of the power that counts as quiet."""

AVERAGED_FRAMES = 5
"""Frames over which the power is averaged before."""

QUIET_TO_MEAN = 0.84
"""That quantile as a share of the mean, for white noise on 13 joints."""


@cache
def _band_pass() -> FloatArray:
    """(FILTER_FRAMES,) the filter. It is made at the first call: scipy.signal imports slowly."""
    taps = scipy.signal.firwin(FILTER_FRAMES, NOISE_BAND, pass_zero=False, window="blackman")
    return np.asarray(taps - taps.mean())  # a still joint must give exactly 0


def noise_power(positions: FloatArray, weights: FloatArray) -> float:
    """The variance of the white noise of x, y and z together, averaged over joints.

    positions: (n, joints, 3). weights: (joints,), sum 1. The result is in squared units of
    `positions`. It is 0 for fewer than MIN_FRAMES frames.
    """
    if len(positions) < MIN_FRAMES:
        return 0.0
    margin = FILTER_FRAMES // 2
    band_pass = _band_pass()
    noise = scipy.ndimage.convolve1d(positions, band_pass, axis=0)[margin:-margin]
    # (n,) the squared amplitude in the band, averaged over joints
    power = np.square(noise).sum(axis=-1) @ weights
    smooth_power = scipy.ndimage.convolve1d(power, np.full(AVERAGED_FRAMES, 1 / AVERAGED_FRAMES))
    gain = float(np.square(band_pass).sum())
    return float(quantile(smooth_power, QUIET_QUANTILE) / (gain * QUIET_TO_MEAN))


@lru_cache(maxsize=256)
def noise_of_speed(spread: float) -> float:
    """How much white noise of variance 1 adds to a squared speed, per squared frame.

    The speed is a central difference of positions smoothed by a Gaussian of `spread` frames.
    """
    turns = np.linspace(0.0, np.pi, 513)
    return float(np.mean(np.square(np.sin(turns)) * np.exp(-np.square(spread * turns))))
