"""Low-pass filters the positions of joints before they are analyzed, as biomechanics does.

Noise of a few millimeters hardly changes a position, but it dominates a velocity, and it fills the
directions in which a covariance matrix is small. So descriptors are computed from smoothed
positions; playback and export read the stored ones.

The filter is Butterworth's of the fourth order: one of the second order that runs forward and
backward, so that there is no delay. The cut-off frequency comes from the recording itself by
residual analysis (Winter, Biomechanics and Motor Control of Human Movement, 2009, section 3.4.4.3):
the residual is what the filter removes, as a function of its cut-off. At high cut-offs it removes
only noise, and the residual of white noise is nearly a straight line. That line, continued to 0 Hz,
is the size of the noise. The chosen cut-off leaves a residual of that size, so the filter distorts
the motion as much as it lets noise pass.

The residuals are computed from one spectrum instead of a filter run for each cut-off, which takes
0.4 ms instead of 320 ms for 5 s of 13 joints at 30 Hz. Shapes: (frames, ...) in and out, in any
unit; rates in Hz.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from app.numerics.arrays import FloatArray
from app.numerics.differences import point_reflected

CUT_OFFS = (4.0, 10.0)
"""Hz: the lowest and the highest cut-off frequency. Human movement needs the lowest."""

CUT_OFF_STEP = 0.25
"""Hz between the cut-offs that are tried."""

LARGEST_TRIED = 20.0
"""Hz. Above, people do not move, and more noise shows nothing new."""

NOISE_BAND = 0.6
"""The residuals from this share of the largest tried cut-off on give the line of the noise."""

MIN_FRAMES = 16
"""The fewest frames for a residual analysis. Shorter clips get the highest cut-off."""

PADDING = 0.75
"""Seconds by which both ends are continued, by point reflection, so that the filter settles."""

_PASSES = 2
_PER_PASS = (2.0 ** (1.0 / _PASSES) - 1.0) ** -0.25
"""The cut-off of one pass as a multiple of that of both passes together."""


def low_passed(samples: FloatArray, rate: float, cut_off: float) -> FloatArray:
    """`samples` (frames, ...) at `rate` without the frequencies above `cut_off`, in Hz.

    The power at the cut-off is halved. If the rate is too low to contain such frequencies, or
    there is only one frame, the samples are returned unchanged.
    """
    of_one_pass = cut_off * _PER_PASS
    if of_one_pass >= rate / 2 or len(samples) < 2:
        return samples
    width = round(PADDING * rate)
    padded = point_reflected(samples, width)
    return there_and_back(butterworth(rate, of_one_pass), padded)[width:-width]


@dataclass(frozen=True, slots=True)
class Filter:
    """A filter of the second order. sections: (1, 6) as in scipy. state: (1, 2) the state in which
    a constant signal of 1 leaves it."""

    sections: FloatArray
    state: FloatArray


@lru_cache(maxsize=64)
def butterworth(rate: float, cut_off: float) -> Filter:
    """The low-pass filter of one pass; rate, cut_off: Hz. Its power at the cut-off is a half.

    It is cached, because its design takes longer than its use on a short clip.
    """
    sections = np.asarray(scipy.signal.butter(2, cut_off, fs=rate, output="sos"))
    return Filter(sections, np.asarray(scipy.signal.sosfilt_zi(sections)))


def there_and_back(one: Filter, samples: FloatArray) -> FloatArray:
    """`samples` (frames, ...) filtered forward and then backward, so that there is no delay.

    The same as scipy's `sosfiltfilt` without padding, which computes the state in each call.
    """
    state = one.state.reshape(*one.state.shape, *[1] * (samples.ndim - 1))
    for _way in ("there", "back"):
        samples, _ = scipy.signal.sosfilt(one.sections, samples, axis=0, zi=state * samples[0])
        samples = samples[::-1]
    return samples


def cut_off_of(positions: FloatArray, rate: float) -> float:
    """Hz: the cut-off of `positions` (frames, joints, 3) at `rate`, within CUT_OFFS."""
    lowest, highest = CUT_OFFS
    tried = np.arange(1.0, min(rate / 2 / _PER_PASS, LARGEST_TRIED), CUT_OFF_STEP)
    noisy = tried >= NOISE_BAND * tried[-1] if len(tried) else np.zeros(0, dtype=bool)
    if len(positions) < MIN_FRAMES or noisy.sum() < 2:
        return highest
    residual = residuals(positions, rate, tried)
    size_of_noise = np.polyfit(tried[noisy], residual[noisy], 1)[1]
    enough = np.flatnonzero(residual <= size_of_noise)
    return float(np.clip(tried[enough[0]] if len(enough) else highest, lowest, highest))


def residuals(positions: FloatArray, rate: float, cut_offs: FloatArray) -> FloatArray:
    """(c,) the root mean square, over frames and coordinates, of what the filter removes.

    positions: (frames, joints, 3) at `rate`. cut_offs: (c,) Hz, below .4 of the rate. The straight
    line from the first to the last frame is removed before, since the spectrum takes the motion as
    periodic.
    """
    frames = len(positions)
    flat = positions.reshape(frames, -1)
    flat = flat - np.linspace(flat[0], flat[-1], frames)
    # (f,) the mean power of the coordinates at each frequency; all but the first occur twice
    power = 2 * np.square(np.abs(np.fft.rfft(flat, axis=0))).mean(axis=1) / frames**2
    # tan: a digital filter squeezes the frequencies up to infinity below half the rate
    frequencies = np.tan(np.pi * np.fft.rfftfreq(frames, 1 / rate) / rate)
    of_one_pass = np.tan(np.pi * cut_offs[:, None] * _PER_PASS / rate)
    # (c, f) the share of an amplitude that both passes let through
    gain = 1 / (1 + (frequencies / of_one_pass) ** 4)
    return np.asarray(np.sqrt(np.square(1 - gain) @ power))
