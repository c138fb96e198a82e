"""Change of frame rate and of sample count, by time, along the first axis.

Between samples we read a cubic Hermite curve with Catmull-Rom tangents: a straight line
would cut the crests of fast movement at 24 Hz and make clips depend on their frame rate.
Before decimation a windowed-sinc low-pass (flat to about 12 Hz of 30) keeps what the
lower rate cannot carry from folding down into it.
Shapes: (frames, ...) in, (samples, ...) out. Any unit.
"""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray

LOW_PASS_REACH = 4.0
"""Half-length of the low-pass, in periods of the lower rate."""

FAR_APART = 8.0
"""Frames between moments from which on only what they read is filtered."""

_ROUNDING = 1e-6


def resample(samples: FloatArray, from_rate: float, to_rate: float) -> FloatArray:
    """Read `samples` (frames, ...) of `from_rate` Hz at `to_rate` Hz.

    The first sample stays at time 0; the result has
    floor((frames - 1) / from_rate * to_rate) + 1 samples, of the input's float type.
    """
    if from_rate <= 0 or to_rate <= 0:
        raise ValueError("frame rates must be positive")
    if from_rate == to_rate or len(samples) < 2:
        return np.array(samples)
    count = int(np.floor((len(samples) - 1) / from_rate * to_rate + _ROUNDING)) + 1
    smooth = low_pass(samples, from_rate / to_rate)
    return sample_at(smooth, np.arange(count) * (from_rate / to_rate))


def resample_to(samples: FloatArray, count: int) -> FloatArray:
    """Read `samples` (frames, ...) at `count` evenly spaced times, both ends included."""
    if len(samples) < 2:
        return np.repeat(samples, count, axis=0)
    step = (len(samples) - 1) / max(count - 1, 1)
    times = np.arange(count) * step
    if step < FAR_APART:
        return sample_at(low_pass(samples, step), times)
    return _few_of_low_pass(samples, step, times)


def sample_at(samples: FloatArray, times: FloatArray) -> FloatArray:
    """Read `samples` (frames, ...) at `times` (n,), in frames, held within the clip.

    Cubic Hermite with Catmull-Rom tangents; exact for straight and parabolic movement.
    """
    last = len(samples) - 1
    if last < 1:
        return np.repeat(samples, len(times), axis=0)
    times = np.clip(times, 0, last)
    left = np.minimum(times.astype(np.int64), last - 1)
    u = (times - left).reshape(-1, *(1,) * (samples.ndim - 1)).astype(samples.dtype)
    slopes = _tangents(samples)
    start, end = samples[left], samples[left + 1]
    rise = end - start
    bend = (slopes[left] - rise) * (1 - u) + (rise - slopes[left + 1]) * u
    return np.asarray(start + u * rise + u * (1 - u) * bend)


def low_pass(samples: FloatArray, ratio: float) -> FloatArray:
    """Remove from `samples` (frames, ...) what a rate `ratio` times lower cannot carry.

    `ratio` <= 1 changes nothing. Both ends are continued by point reflection, so that the
    first and last samples stay where they are and steady movement stays steady.
    """
    if ratio <= 1 or len(samples) < 2:
        return samples
    kernel = _sinc(ratio)
    reach = len(kernel) // 2
    return np.asarray(
        scipy.ndimage.convolve1d(_continued(samples, reach), kernel, axis=0)[reach:-reach]
    )


def _few_of_low_pass(samples: FloatArray, ratio: float, times: FloatArray) -> FloatArray:
    """`sample_at(low_pass(samples, ratio), times)`, at a cost that the moments set.

    A whole clip through a filter that grows with it would cost the square of its length.
    """
    kernel, last = _sinc(ratio), len(samples) - 1
    continued = _continued(samples, len(kernel) // 2)
    read = np.empty((len(times), *samples.shape[1:]), dtype=samples.dtype)
    for number, time in enumerate(np.clip(times, 0, last)):
        # Four frames: those around the moment, and what their tangents look at.
        first = min(max(int(time) - 1, 0), last - 3)
        around = (continued[f : f + len(kernel)] for f in range(first, first + 4))
        smooth = np.array([np.tensordot(kernel, part, axes=1) for part in around])
        read[number] = sample_at(smooth, np.array([time - first]))[0]
    return read


def _sinc(ratio: float) -> FloatArray:
    reach = int(np.ceil(LOW_PASS_REACH * ratio))
    offsets = np.arange(-reach, reach + 1)
    kernel = np.sinc(offsets / ratio) * np.cos(0.5 * np.pi * offsets / (reach + 1)) ** 2
    return np.asarray(kernel / kernel.sum())


def _continued(samples: FloatArray, reach: int) -> FloatArray:
    width = [(reach, reach)] + [(0, 0)] * (samples.ndim - 1)
    return np.pad(samples, width, mode="reflect", reflect_type="odd")


def _tangents(samples: FloatArray) -> FloatArray:
    """Slope per frame at each sample; central inside, parabolic at the ends."""
    if len(samples) == 2:
        return np.repeat(samples[1:] - samples[:1], 2, axis=0)
    return np.asarray(np.gradient(samples, axis=0, edge_order=2))
