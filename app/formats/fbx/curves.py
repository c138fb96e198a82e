"""The animation curves of an FBX file: keys, and values between them.

A key says how the curve goes on to the next: constant, linear, or a Bezier cubic whose
tangents have a slope and a length (a weight, in parts of the gap). Tangents are stored,
or follow from the neighbors ("auto"). Before the first and after the last key the curve
is constant. Times are ticks, KTIME a second.

Source: the flags of `fbxanimcurve.h` (Autodesk FBX SDK 2020) and its reference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.fbx.scene import FbxObject, refused_at
from app.numerics.arrays import BoolArray, FloatArray, IntArray

KTIME = 46_186_158_000
"""The number of ticks in a second."""
ON_KEY = 1e-6
"""The share of a gap within which a time counts as that of the key."""
USUAL_WEIGHT = 1 / 3
WEIGHT_UNIT = 1e-4

_CONSTANT, _LINEAR, _CUBIC = 0x2, 0x4, 0x8
_NEXT = 0x100
"""With _CONSTANT: the value is that of the next key."""
_TCB, _USER = 0x200, 0x400
_CLAMP, _TIMED, _PROGRESSIVE = 0x1000, 0x2000, 0x4000
"""Flags of automatic tangents: flat next to an equal value; along the chord of the neighbors
instead of the mean slope of both sides; never beyond the values of the neighbors."""
_WEIGHTED_RIGHT, _WEIGHTED_NEXT_LEFT = 0x1000000, 0x2000000
_FLAT = 1e-4
"""A clamped tangent is flat if neighboring values differ by less."""
_SOLVING_STEPS = 60
_SOLVED = 1e-12
"""Parts of a gap."""
_CONSTANT_BEYOND = (b"C", ord("C"))


@dataclass(frozen=True, slots=True)
class Keys:
    """times (keys,) ticks, ascending; values (keys,); flags (keys,); data (keys, 4): right
    slope, next left slope (a second), both weights and velocities as bits."""

    times: IntArray
    values: FloatArray
    flags: IntArray
    data: FloatArray

    def __len__(self) -> int:
        return len(self.times)


def read_times(curve: FbxObject) -> IntArray:
    """(keys,) ticks, ascending. Raises Unreadable, TooLarge."""
    times = _integers(curve, "KeyTime")
    # Differences of far apart int64 would wrap.
    if np.any(times[1:] < times[:-1]):
        raise curve.unreadable("expected times of keys in ascending order")
    return times


def read_keys(curve: FbxObject) -> Keys:
    """Raises Unreadable, TooLarge."""
    times, values = read_times(curve), _floats(curve, "KeyValueFloat")
    if len(times) != len(values):
        raise curve.unreadable(f"expected {len(times)} values of keys, found {len(values)}")
    if not np.all(np.abs(values) <= MAX_MAGNITUDE):
        raise curve.unreadable(f"expected values of keys within ±{MAX_MAGNITUDE:g}")
    if len(times) < 2:
        return Keys(times, values, np.full(len(times), _LINEAR), np.zeros((len(times), 4)))
    return Keys(times, values, *_attributes(curve, len(times)))


def _attributes(curve: FbxObject, keys: int) -> tuple[IntArray, FloatArray]:
    """Flags (keys,) and data (keys, 4), which runs of keys share."""
    flags, data = _integers(curve, "KeyAttrFlags"), _floats(curve, "KeyAttrDataFloat")
    counts = _integers(curve, "KeyAttrRefCount")
    fits = len(flags) == len(counts) and len(data) == 4 * len(flags)
    if not fits or np.any(counts < 0) or counts.sum() != keys:
        raise curve.unreadable(f"expected attributes of {keys} keys")
    # Weights are integers in the bits of a float, which may be those of NaN: copies keep them.
    run = np.repeat(np.arange(len(flags)), counts)
    return flags[run], data.reshape(-1, 4)[run]


def _integers(curve: FbxObject, name: str) -> IntArray:
    return _array(curve, name, "i").astype(np.int64)


def _floats(curve: FbxObject, name: str) -> FloatArray:
    found = _array(curve, name, "f")
    return found.astype(np.float32, copy=False)


def _array(curve: FbxObject, name: str, kind: str) -> FloatArray | IntArray:
    """(n,) the numbers of a child; empty if there is no such child."""
    record = curve.record.child(name)
    found = record.array() if record is not None else np.zeros(0)
    if len(found) and found.dtype.kind != kind:
        raise curve.unreadable(f"expected other numbers as {name}")
    return found


def sample(curve: FbxObject, ticks: FloatArray) -> FloatArray | None:
    """Values (n,) float64 at `ticks` (n,) ascending; None for a curve without keys.

    Raises Unreadable, TooLarge, FormatNotSupported (interpolation that we do not know).
    """
    keys = read_keys(curve)
    if not len(keys):
        return None
    after = np.searchsorted(keys.times, ticks, side="right")
    values = keys.values.astype(np.float64)
    result = values[np.clip(after - 1, 0, None)]
    inside = (after > 0) & (after < len(keys))
    if not inside.all():
        _refuse_going_on(curve, keys, ticks)
    left = after[inside] - 1
    span = (keys.times[left + 1] - keys.times[left]).astype(np.float64)
    along = (ticks[inside] - keys.times[left]) / span
    between = (along > ON_KEY) & (along < 1 - ON_KEY)
    result[inside] = np.where(along < 0.5, values[left], values[left + 1])
    found = np.flatnonzero(inside)[between]
    result[found] = _between(curve, keys, left[between], along[between])
    return result


def _refuse_going_on(curve: FbxObject, keys: Keys, ticks: FloatArray) -> None:
    """Refuse curves that repeat or continue outside their keys."""
    for name, beyond in (
        ("Pre-Extrapolation", ticks[0] < keys.times[0]),
        ("Post-Extrapolation", ticks[-1] > keys.times[-1]),
    ):
        record = curve.record.child(name)
        kind = record.child("Type") if record is not None and beyond else None
        if kind is not None and next(iter(kind.properties(1)), b"C") not in _CONSTANT_BEYOND:
            raise refused_at(curve.place, f"expected a constant {name}")


def _between(curve: FbxObject, keys: Keys, left: IntArray, along: FloatArray) -> FloatArray:
    """Values (n,) in the gaps after the keys `left` (n,), at `along` (n,) of each gap."""
    flags = keys.flags[left]
    start = keys.values[left].astype(np.float64)
    end = keys.values[left + 1].astype(np.float64)
    result = start + (end - start) * along
    constant = flags & _CONSTANT != 0
    result[constant] = np.where(flags & _NEXT != 0, end, start)[constant]
    cubic = (flags & _CUBIC != 0) & ~constant
    if cubic.any():
        result[cubic] = _cubic(curve, keys, left[cubic], along[cubic])
    if np.any(flags & (_CONSTANT | _LINEAR | _CUBIC) == 0):
        raise refused_at(curve.place, "expected constant, linear or cubic keys")
    return result


def _cubic(curve: FbxObject, keys: Keys, left: IntArray, along: FloatArray) -> FloatArray:
    gaps, where = np.unique(left, return_inverse=True)
    ends = keys.flags[gaps] | np.where(_is_cubic(keys.flags[gaps + 1]), keys.flags[gaps + 1], 0)
    if np.any(ends & _TCB):
        raise refused_at(curve.place, "expected no TCB keys")
    seconds = (keys.times[gaps + 1] - keys.times[gaps]) / KTIME
    right, next_left = _weights(keys, gaps)
    slopes = _slopes(keys, gaps)
    x1, x2 = right, 1 - next_left
    y0 = keys.values[gaps].astype(np.float64)
    y3 = keys.values[gaps + 1].astype(np.float64)
    y1 = y0 + right * seconds * slopes[0]
    y2 = y3 - next_left * seconds * slopes[1]
    t = _solve_bezier(x1[where], x2[where], along)
    return _bezier(y0[where], y1[where], y2[where], y3[where], t)


def _is_cubic(flags: IntArray) -> BoolArray:
    return np.asarray((flags & _CUBIC != 0) & (flags & _CONSTANT == 0))


def _weights(keys: Keys, gaps: IntArray) -> tuple[FloatArray, FloatArray]:
    """(n,) lengths of the tangents at both ends of gaps, in parts of the gap, 0 to 1."""
    bits = np.ascontiguousarray(keys.data[gaps, 2], dtype=np.float32).view(np.uint32)
    right = np.where(
        keys.flags[gaps] & _WEIGHTED_RIGHT, (bits & 0xFFFF) * WEIGHT_UNIT, USUAL_WEIGHT
    )
    left = np.where(
        keys.flags[gaps] & _WEIGHTED_NEXT_LEFT, (bits >> 16) * WEIGHT_UNIT, USUAL_WEIGHT
    )
    return np.clip(right, 0, 1), np.clip(left, 0, 1)


def _slopes(keys: Keys, gaps: IntArray) -> tuple[FloatArray, FloatArray]:
    """(n,) slopes a second at both ends of gaps."""
    stored = np.nan_to_num(keys.data[gaps, :2].astype(np.float64), posinf=0, neginf=0)
    stored = np.clip(stored, -MAX_MAGNITUDE, MAX_MAGNITUDE)
    automatic = _is_cubic(keys.flags) & (keys.flags & _USER == 0)
    # What is stored of an automatic tangent is its bias, in percent.
    bias = stored / 100
    start = np.where(automatic[gaps], _auto_slopes(keys, gaps, bias[:, 0]), stored[:, 0])
    end = np.where(automatic[gaps + 1], _auto_slopes(keys, gaps + 1, -bias[:, 1]), stored[:, 1])
    return start, end


def _auto_slopes(keys: Keys, at: IntArray, bias: FloatArray) -> FloatArray:
    """(n,) slopes of automatic tangents at keys `at`; bias (n,) leans them to the
    slope on the right, or the left where it is negative; beyond 1 they go on beyond it."""
    down, before = _rise_and_run(keys, np.maximum(at - 1, 0), at)
    up, after = _rise_and_run(keys, at, np.minimum(at + 1, len(keys) - 1))
    left, right = _ratio(down, before), _ratio(up, after)
    flags = keys.flags[at]
    leaning = np.where(bias > 0, right, left)
    mean = (left + right) / 2
    slope = mean + np.abs(bias) * (leaning - mean)
    slope = np.where(flags & _TIMED != 0, _ratio(down + up, before + after), slope)
    flat = np.minimum(np.abs(down), np.abs(up)) < _FLAT
    slope = np.where(flat & (flags & _CLAMP != 0), 0.0, slope)
    limited = _limited(slope, left / USUAL_WEIGHT, right / USUAL_WEIGHT)
    slope = np.where(flags & _PROGRESSIVE != 0, limited, slope)
    outer = (before <= 0) | (after <= 0)
    return np.where(outer, np.where(flags & _PROGRESSIVE != 0, 0.0, left + right), slope)


def _rise_and_run(keys: Keys, start: IntArray, end: IntArray) -> tuple[FloatArray, FloatArray]:
    """(n,) difference of the values, and seconds, between two keys."""
    rise = keys.values[end].astype(np.float64) - keys.values[start]
    return rise, (keys.times[end] - keys.times[start]) / KTIME


def _ratio(rise: FloatArray, run: FloatArray) -> FloatArray:
    return np.divide(rise, run, out=np.zeros(len(run)), where=run > 0)


def _limited(slope: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
    """(n,) slopes no steeper than both limits, flat where these point the other way."""
    sign = np.where(slope < 0, -1.0, 1.0)
    limit = np.minimum(sign * left, sign * right)
    return np.asarray(sign * np.minimum(np.abs(slope), np.maximum(limit, 0)))


def _solve_bezier(x1: FloatArray, x2: FloatArray, x: FloatArray) -> FloatArray:
    """(n,) parameters at which cubics from 0 to 1 with inner points x1, x2 in [0, 1] reach x.

    They ascend, so halving finds the parameter; Newton's steps shorten it where they stay
    within the bracket.
    """
    low, high, t = np.zeros(len(x)), np.ones(len(x)), x.copy()
    for _ in range(_SOLVING_STEPS):
        miss = _bezier(0.0, x1, x2, 1.0, t) - x
        away = np.abs(miss) > _SOLVED
        if not away.any():
            break
        low, high = np.where(miss < 0, t, low), np.where(miss < 0, high, t)
        steep = 3 * ((1 - t) ** 2 * x1 + 2 * (1 - t) * t * (x2 - x1) + t**2 * (1 - x2))
        step = t - np.divide(miss, steep, out=np.zeros(len(x)), where=steep > 1e-9)
        halved = (step <= low) | (step >= high)
        t = np.where(away, np.where(halved, (low + high) / 2, step), t)
    return t


def _bezier(
    y0: FloatArray | float,
    y1: FloatArray,
    y2: FloatArray,
    y3: FloatArray | float,
    t: FloatArray,
) -> FloatArray:
    s = 1 - t
    return np.asarray(s**3 * y0 + 3 * (s**2 * t * y1 + s * t**2 * y2) + t**3 * y3)
