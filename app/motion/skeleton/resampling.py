"""Changes the frame rate or the number of samples, along the first axis.

Between samples, the motion is a cubic Hermite curve with Catmull-Rom tangents. Straight lines
would cut the peaks of fast movement at 24 Hz, so that results would depend on the frame rate.
Before the rate is lowered, a windowed-sinc low-pass filter (flat to about 12 Hz of 30) removes
frequencies that the lower rate cannot represent, which avoids aliasing. The filter grows with the
ratio of the rates. If the ratio is at least MIN_FAR_RATIO, only the frames that are read are
filtered, so that the cost depends only on the length of the clip. Long clips are processed in
blocks. Shapes: (frames, ...) in, (samples, ...) out. Any unit.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy

from app.deadline import check
from app.numerics.arrays import FloatArray
from app.numerics.differences import central_differences, point_reflected

LOW_PASS_REACH = 4.0
"""Half of the length of the low-pass filter, in periods of the lower rate."""

MIN_FAR_RATIO = 8.0
"""From this ratio of the rates on, only the frames that are read are filtered."""

NUMBERS_AT_ONCE = 2_000_000
"""Numbers of one block. It limits the memory and the time of a step."""

CURVE_FRAMES = 4
"""Frames that determine the curve at a time: two neighbors, and two more for the tangents."""

_ROUNDING = 1e-6
"""Added to a number of samples before it is rounded down, because the division is not exact."""


def some_frames(samples: FloatArray, most: int) -> FloatArray:
    """(n, ...) evenly spaced samples of `samples` (frames, ...), at most `most`, without a copy."""
    return samples[:: max(1, -(-len(samples) // most))]


def resample(samples: FloatArray, from_rate: float, to_rate: float) -> FloatArray:
    """(samples, ...) `samples` (frames, ...) of `from_rate` Hz, at `to_rate` Hz.

    The first sample stays at time 0. The result has
    floor((frames - 1) / from_rate * to_rate) + 1 samples, in the float type of the input.
    Raises ValueError if a rate is not positive.
    """
    if from_rate <= 0 or to_rate <= 0:
        raise ValueError("frame rates must be positive")
    if from_rate == to_rate or len(samples) < 2:
        return np.array(samples)
    count = int(np.floor((len(samples) - 1) / from_rate * to_rate + _ROUNDING)) + 1
    return _at_steps(samples, from_rate / to_rate, count)


def resample_to(samples: FloatArray, count: int) -> FloatArray:
    """(count, ...) `samples` (frames, ...) at evenly spaced times, including both ends."""
    if len(samples) < 2:
        return np.repeat(samples, count, axis=0)
    return _at_steps(samples, (len(samples) - 1) / max(count - 1, 1), count)


def _at_steps(samples: FloatArray, step: float, count: int) -> FloatArray:
    """(count, ...) low-pass filtered samples from the first frame on, `step` frames apart."""
    times = np.arange(count) * step
    if step < MIN_FAR_RATIO or len(samples) < CURVE_FRAMES:
        return sample_at(low_pass(samples, step), times)
    return _few_of_low_pass(samples, step, times)


def sample_at(samples: FloatArray, times: FloatArray) -> FloatArray:
    """(n, ...) `samples` (frames, ...) at `times` (n,), in frames, clipped to the clip.

    The curve is a cubic Hermite one with Catmull-Rom tangents. It is exact for straight and
    parabolic movement.
    """
    last = len(samples) - 1
    if last < 1:
        return np.repeat(samples, len(times), axis=0)
    times = np.clip(times, 0, last)
    slopes = _tangents(samples)
    read = np.empty((len(times), *samples.shape[1:]), dtype=samples.dtype)
    for some in _blocks(read):
        left = np.minimum(times[some].astype(np.int64), last - 1)
        u = (times[some] - left).reshape(-1, *(1,) * (samples.ndim - 1)).astype(samples.dtype)
        start, end = samples[left], samples[left + 1]
        rise = end - start
        bend = (slopes[left] - rise) * (1 - u) + (rise - slopes[left + 1]) * u
        read[some] = start + u * rise + u * (1 - u) * bend
    return read


def low_pass(samples: FloatArray, ratio: float) -> FloatArray:
    """`samples` (frames, ...) without frequencies that a `ratio` times lower rate cannot represent.

    A `ratio` up to 1 changes nothing. Both ends are continued by point reflection, so that the
    first and the last sample, and steady movement, do not change.
    """
    if ratio <= 1 or len(samples) < 2:
        return samples
    kernel = _sinc(ratio)
    reach = len(kernel) // 2
    continued, smooth = _continued(samples, reach), np.empty_like(samples)
    for some in _blocks(samples):
        around = continued[some.start : some.stop + 2 * reach]
        smooth[some] = scipy.ndimage.convolve1d(around, kernel, axis=0)[reach : len(around) - reach]
    return smooth


def _few_of_low_pass(samples: FloatArray, ratio: float, times: FloatArray) -> FloatArray:
    """(n, ...) the same as `sample_at(low_pass(samples, ratio), times)`, but faster for few times.

    The length of the filter grows with `ratio`, which may be nearly the length of the clip. To
    filter all frames would cost the square of this length.
    """
    kernel, last = _sinc(ratio), len(samples) - 1
    continued = _continued(samples, len(kernel) // 2).reshape(-1, samples[0].size)
    # Row r has the kernel moved by r frames, so the rows give CURVE_FRAMES filtered frames.
    kernels = np.zeros((CURVE_FRAMES, len(kernel) + CURVE_FRAMES - 1))
    for row in range(CURVE_FRAMES):
        kernels[row, row : row + len(kernel)] = kernel
    read = np.empty((len(times), samples[0].size), dtype=samples.dtype)
    for number, time in enumerate(np.clip(times, 0, last)):
        check()
        first = min(max(int(time) - 1, 0), last + 1 - CURVE_FRAMES)
        smooth = kernels @ continued[first : first + kernels.shape[1]]
        read[number] = sample_at(smooth, np.array([time - first]))[0]
    return read.reshape(len(times), *samples.shape[1:])


def _blocks(samples: FloatArray) -> Iterator[slice]:
    """Blocks of the frames of `samples` (frames, ...). The deadline is checked at each block."""
    frames = max(1, NUMBERS_AT_ONCE // max(1, samples[:1].size))
    for first in range(0, len(samples), frames):
        check()
        yield slice(first, min(first + frames, len(samples)))


def _sinc(ratio: float) -> FloatArray:
    """(n,) a sinc filter with a squared cosine window and the sum 1; n is odd."""
    reach = int(np.ceil(LOW_PASS_REACH * ratio))
    offsets = np.arange(-reach, reach + 1)
    kernel = np.sinc(offsets / ratio) * np.cos(0.5 * np.pi * offsets / (reach + 1)) ** 2
    return np.asarray(kernel / kernel.sum())


def _continued(samples: FloatArray, reach: int) -> FloatArray:
    """(reach + frames + reach, ...) the samples, continued by point reflection at both ends."""
    return point_reflected(samples, reach)


def _tangents(samples: FloatArray) -> FloatArray:
    """(frames, ...) the slope per frame at each sample: central inside, parabolic at the ends."""
    if len(samples) == 2:
        return np.repeat(samples[1:] - samples[:1], 2, axis=0)
    slopes = central_differences(samples)
    slopes[0] = -1.5 * samples[0] + 2.0 * samples[1] - 0.5 * samples[2]
    slopes[-1] = 0.5 * samples[-3] - 2.0 * samples[-2] + 1.5 * samples[-1]
    return slopes
