"""Finds the times at which a glTF animation is sampled. The format has no frame rate.

If keys are evenly spaced and dense, they are samples, and their rate is the frame rate. Otherwise
the usual rate with most keys on whole frames is used.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.formats.bvh.frames import MAX_FRAMES, MAX_RATE
from app.formats.common.failures import too_large
from app.numerics.arrays import FloatArray

USUAL_RATES = (30.0, 24.0, 25.0, 60.0, 50.0, 120.0, 100.0)
"""Hz, the most usual first."""
DEFAULT_RATE = 30.0
"""Hz: the rate for keys that fit no usual rate."""
MIN_SAMPLED_RATE = 8.0
"""Hz. Keys that are farther apart were set by hand, and the motion between them matters."""
MIN_EQUAL_SHARE = 0.5
"""The share of gaps that must be equal, so that keys count as samples."""
GAP_TOLERANCE = 0.02
"""Gaps that differ by less (relative) count as equal, because times are float32."""
NEAR_WHOLE = 1e-3
"""The relative distance from a whole number up to which a rate is rounded to it."""
ON_FRAME = 0.02
"""The largest distance of a key from a frame on which it is, as a share of a frame's duration."""
MIN_ON_FRAME_SHARE = 0.95
MAX_FREE_FRAMES, MAX_FRAMES_PER_KEY = 10_000, 1_000
"""The most frames of a clip: a constant, and a number for each key of its longest sampler. So a
single far key does not add hours without movement."""


def span_of(times: Sequence[FloatArray]) -> tuple[float, float] | None:
    """The first and the last time with keys; None if there are none.

    times: (keys,) seconds of each sampler.
    """
    # A single key only gives the value of a property that does not change.
    moving = [one for one in times if len(one) > 1] or list(times)
    if not moving:
        return None
    return min(float(one[0]) for one in moving), max(float(one[-1]) for one in moving)


def frame_times(times: Sequence[FloatArray], span: tuple[float, float]) -> tuple[FloatArray, float]:
    """(frames,) the times of the frames in seconds, and their rate in Hz. Raises TooLarge."""
    rate = _rate(times)
    count = int((span[1] - span[0]) * rate + ON_FRAME) + 1
    limit = min(MAX_FRAMES, MAX_FREE_FRAMES + MAX_FRAMES_PER_KEY * max(map(len, times)))
    if count > limit:
        raise too_large("frames", f"expected at most {limit}, found {count}")
    return np.clip(span[0] + np.arange(count) / rate, *span), rate


def _rate(times: Sequence[FloatArray]) -> float:
    even = [rate for one in times if (rate := _even_rate(one)) is not None]
    if even:
        return max(even)
    keys = np.unique(np.concatenate(times)) - min(float(one[0]) for one in times)
    for rate in USUAL_RATES:
        phase = keys * rate
        if np.mean(np.abs(phase - np.round(phase)) <= ON_FRAME) >= MIN_ON_FRAME_SHARE:
            return rate
    return DEFAULT_RATE


def _even_rate(times: FloatArray) -> float | None:
    """Hz: the rate of evenly spaced keys (keys,) in seconds; None if they are not."""
    gaps = np.diff(times)
    gaps = gaps[gaps > 0]
    if len(gaps) < 2:
        return None
    usual = float(np.median(gaps))
    equal = np.abs(gaps - usual) <= GAP_TOLERANCE * usual
    if np.mean(equal) < MIN_EQUAL_SHARE:
        return None
    # The mean of many gaps is more exact than a single one.
    rate = 1 / float(gaps[equal].mean())
    if not MIN_SAMPLED_RATE <= rate <= MAX_RATE:
        return None
    whole = round(rate)
    return float(whole) if abs(rate - whole) <= NEAR_WHOLE * rate else rate
