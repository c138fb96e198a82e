"""Finds the times at which an FBX clip is sampled: the start, the end and the frame rate.

The rate is that of the scene (TimeMode), unless the keys are denser. Dense keys are samples of a
higher rate, and the rate of a scene is often only the default of the program.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.bvh.frames import MAX_FRAMES, MAX_RATE, MIN_RATE, NEAR_WHOLE
from app.formats.common.failures import too_large
from app.formats.fbx.curves import KTIME
from app.formats.fbx.objects import Numbers
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray

NTSC = 1000 / 1001
TIME_MODES: dict[int, float] = {
    1: 120.0, 2: 100.0, 3: 60.0, 4: 50.0, 5: 48.0, 6: 30.0, 7: 30.0, 8: 30 * NTSC, 9: 30 * NTSC,
    10: 25.0, 11: 24.0, 12: 1000.0, 13: 24 * NTSC, 15: 96.0, 16: 72.0, 17: 60 * NTSC,
    18: 120 * NTSC,
}  # fmt: skip
"""The rate in Hz for each number of TimeMode; 14 is CustomFrameRate, 0 gives no rate."""
CUSTOM_MODE = 14
DEFAULT_RATE = 30.0
"""Hz: the rate for sparse keys in a scene without a rate."""
MAX_SCENE_RATE = 250.0
"""Hz. A higher rate of a scene is the rate of its clock, not of its motion."""
MIN_EQUAL_SHARE = 0.5
"""The share of gaps that must be equal, so that keys count as samples."""
GAP_TOLERANCE = 0.01
"""Gaps that differ by less (relative) count as equal, because some writers round times."""
MAX_FREE_FRAMES, MAX_FRAMES_PER_KEY = 10_000, 1_000
"""The most frames of a clip: a constant, and a number for each key of its longest curve. So a
single far key does not add hours without movement."""
ON_FRAME = 0.02
"""The largest distance of a key from a frame on which it is, as a share of a frame's duration."""


@dataclass(frozen=True, slots=True)
class Timing:
    """ticks: (frames,) float64 the times of the frames. frame_rate: Hz."""

    ticks: FloatArray
    frame_rate: float
    cautions: tuple[Caution, ...] = ()


def key_span(
    times: list[IntArray], start: float | None, stop: float | None
) -> tuple[float, float] | None:
    """The first and the last tick with keys; None if there are no keys.

    times: (keys,) ticks for each curve. start, stop: the span of the stack in ticks, or None. If
    there are keys in this span, the result is limited to it.
    """
    # A single key only gives the value of a property that does not change.
    moving = [one for one in times if len(one) > 1] or times
    if not moving:
        return None
    first = float(min(int(one[0]) for one in moving))
    last = float(max(int(one[-1]) for one in moving))
    if start is not None and stop is not None and first < stop and start < last and start < stop:
        return max(first, start), min(last, stop)
    return first, last


def find_timing(
    times: list[IntArray], span: tuple[float, float], settings: dict[str, Numbers]
) -> Timing:
    """The times and the rate of the frames.

    times: (keys,) ticks for each curve. span: the first and the last tick. settings: the numbers of
    GlobalSettings. Raises TooLarge.
    """
    scene, keys = scene_rate(settings), key_rate(times)
    rate = scene or keys or DEFAULT_RATE
    cautions: tuple[Caution, ...] = ()
    if keys and (rate > MAX_SCENE_RATE or keys > rate * (1 + GAP_TOLERANCE)):
        rate = keys
        detail = f"the rate of the scene is {scene or 0:g} Hz, but it has {keys:g} keys per second"
        cautions = (Caution("frame_rate_from_keys", detail),)
    period = KTIME / rate
    first = span[0]
    # If keys are on frames, the first frame is on one too, also if the span starts between two.
    if _are_on_frames(times, period):
        first = np.ceil(first / period - ON_FRAME) * period
    count = int((span[1] - first) / period + ON_FRAME) + 1
    longest = max((len(one) for one in times), default=0)
    limit = min(MAX_FRAMES, MAX_FREE_FRAMES + MAX_FRAMES_PER_KEY * longest)
    if count > limit:
        raise too_large("frames", f"expected at most {limit}, found {count}")
    ticks = np.clip(first + period * np.arange(max(count, 1)), *span)
    return Timing(ticks, rate, cautions)


def scene_rate(settings: dict[str, Numbers]) -> float | None:
    """The rate of GlobalSettings in Hz; None if there is none or if it is impossible."""
    mode = int(settings.get("TimeMode", (0.0,))[0]) if _finite(settings, "TimeMode") else 0
    if mode == CUSTOM_MODE and _finite(settings, "CustomFrameRate"):
        rate = settings["CustomFrameRate"][0]
        return rate if MIN_RATE <= rate <= MAX_RATE else None
    return TIME_MODES.get(mode)


def _finite(settings: dict[str, Numbers], name: str) -> bool:
    return name in settings and bool(np.isfinite(settings[name][0]))


def key_rate(times: list[IntArray]) -> float | None:
    """The rate of evenly spaced keys in Hz; None if they are not evenly spaced.

    times: (keys,) ticks for each curve.
    """
    if not times:
        return None
    gaps = np.concatenate([np.diff(one) for one in times]).astype(np.float64)
    gaps = gaps[gaps > 0]
    if not len(gaps):
        return None
    usual = float(np.median(gaps))
    if np.mean(np.abs(gaps - usual) <= GAP_TOLERANCE * usual) < MIN_EQUAL_SHARE:
        return None
    rate = KTIME / usual
    if not MIN_RATE <= rate <= MAX_RATE:
        return None
    # Times are rounded to ticks, so a rate near a usual one is that rate.
    usual_rates = (float(round(rate)), *TIME_MODES.values())
    return next((one for one in usual_rates if abs(one - rate) <= NEAR_WHOLE * rate), rate)


def _are_on_frames(times: list[IntArray], period: float) -> bool:
    """Whether most keys are on whole frames, counted from time 0."""
    phase = np.concatenate([one / period for one in times])
    return bool(np.mean(np.abs(phase - np.round(phase)) <= ON_FRAME) > MIN_EQUAL_SHARE)
