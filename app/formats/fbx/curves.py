"""Reads the animation curves of an FBX file: keys, and values between keys.

The flags of a key decide how the curve continues to the next key: constant, linear, or as a cubic
Bezier curve. The tangents of a Bezier curve have a slope and a length (the weight, as a share of
the gap between the keys). Tangents are stored in the file, or follow from the neighboring keys
("auto"). Before the first key and after the last key the curve is constant. Times are in ticks.

Source: the flags in `fbxanimcurve.h` (Autodesk FBX SDK 2020), and the reference of the SDK.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.fbx.objects import FbxObject, unsupported_at
from app.numerics.arrays import BoolArray, FloatArray, IntArray

KTIME = 46_186_158_000
"""The number of ticks in a second."""
ON_KEY = 1e-6
"""The share of a gap within which a time counts as the time of the key."""
USUAL_WEIGHT = 1 / 3
"""The length of a tangent that has no weight, as a share of the gap."""
WEIGHT_UNIT = 1e-4
"""Stored weights are integers in this unit."""

_CONSTANT, _LINEAR, _CUBIC = 0x2, 0x4, 0x8
_NEXT = 0x100
"""With _CONSTANT: the curve has the value of the next key."""
_TCB, _USER = 0x200, 0x400
_CLAMP, _TIMED, _PROGRESSIVE = 0x1000, 0x2000, 0x4000
"""Flags of automatic tangents. _CLAMP: flat if a neighbor has an equal value. _TIMED: the slope
from the previous to the next key, and not the mean slope of both gaps. _PROGRESSIVE: the curve does
not go beyond the values of the neighbors."""
_WEIGHTED_RIGHT, _WEIGHTED_NEXT_LEFT = 0x1000000, 0x2000000
_FLAT = 1e-4
"""Neighboring values that differ by less count as equal for _CLAMP."""
_SOLVING_STEPS = 60
_SOLVED = 1e-12
"""The largest error of a solved time, as a share of the gap."""
_CONSTANT_BEYOND = (b"C", ord("C"))


@dataclass(frozen=True, slots=True)
class Keys:
    """The keys of a curve.

    times: (keys,) ticks, ascending. values: (keys,). flags: (keys,) bits. data: (keys, 4) the slope
    to the right of the key and to the left of the next key, both per second; then the two weights
    and the two velocities, as bits of a float.
    """

    times: IntArray
    values: FloatArray
    flags: IntArray
    data: FloatArray

    def __len__(self) -> int:
        return len(self.times)


def read_times(curve: FbxObject) -> IntArray:
    """(keys,) the times of the keys in ticks, ascending. Raises Unreadable, TooLarge."""
    times = _integers(curve, "KeyTime")
    # Compared, not subtracted, because differences of large int64 numbers can overflow.
    if np.any(times[1:] < times[:-1]):
        raise curve.unreadable("expected times of keys in ascending order")
    return times


def read_keys(curve: FbxObject) -> Keys:
    """The keys of a curve. Raises Unreadable, TooLarge."""
    times, values = read_times(curve), _floats(curve, "KeyValueFloat")
    if len(times) != len(values):
        raise curve.unreadable(f"expected {len(times)} values of keys, found {len(values)}")
    if not np.all(np.abs(values) <= MAX_MAGNITUDE):
        raise curve.unreadable(f"expected values of keys within ±{MAX_MAGNITUDE:g}")
    if len(times) < 2:
        return Keys(times, values, np.full(len(times), _LINEAR), np.zeros((len(times), 4)))
    return Keys(times, values, *_attributes(curve, len(times)))


def _attributes(curve: FbxObject, keys: int) -> tuple[IntArray, FloatArray]:
    """Flags (keys,) and data (keys, 4). The file stores them once for each run of equal keys."""
    flags, data = _integers(curve, "KeyAttrFlags"), _floats(curve, "KeyAttrDataFloat")
    counts = _integers(curve, "KeyAttrRefCount")
    fits = len(flags) == len(counts) and len(data) == 4 * len(flags)
    if not fits or np.any(counts < 0) or counts.sum() != keys:
        raise curve.unreadable(f"expected attributes of {keys} keys")
    # Weights are integers in the bits of a float. These may be the bits of a NaN, so the array is
    # only copied: a computation could change them.
    run = np.repeat(np.arange(len(flags)), counts)
    return flags[run], data.reshape(-1, 4)[run]


def _integers(curve: FbxObject, name: str) -> IntArray:
    return _array(curve, name, "i").astype(np.int64)


def _floats(curve: FbxObject, name: str) -> FloatArray:
    found = _array(curve, name, "f")
    return found.astype(np.float32, copy=False)


def _array(curve: FbxObject, name: str, kind: str) -> FloatArray | IntArray:
    """(n,) the numbers of a child record; empty if there is no child with this name."""
    record = curve.record.child(name)
    found = record.array() if record is not None else np.zeros(0)
    if len(found) and found.dtype.kind != kind:
        raise curve.unreadable(f"expected other numbers as {name}")
    return found


def sample(curve: FbxObject, ticks: FloatArray) -> FloatArray | None:
    """(n,) float64 the values at `ticks` (n,), which ascend; None for a curve without keys.

    Raises Unreadable, TooLarge, and FormatNotSupported for an interpolation that is not supported.
    """
    keys = read_keys(curve)
    if not len(keys):
        return None
    after = np.searchsorted(keys.times, ticks, side="right")
    values = keys.values.astype(np.float64)
    result = values[np.clip(after - 1, 0, None)]
    # result (n,): the last key before each time, then overwritten between two keys
    inside = (after > 0) & (after < len(keys))
    if not inside.all():
        _refuse_extrapolation(curve, keys, ticks)
    # left, along (times between keys,): the key before, and the share of the gap after it
    left = after[inside] - 1
    span = (keys.times[left + 1] - keys.times[left]).astype(np.float64)
    along = (ticks[inside] - keys.times[left]) / span
    between = (along > ON_KEY) & (along < 1 - ON_KEY)
    result[inside] = np.where(along < 0.5, values[left], values[left + 1])
    found = np.flatnonzero(inside)[between]
    result[found] = _between(curve, keys, left[between], along[between])
    return result


def _refuse_extrapolation(curve: FbxObject, keys: Keys, ticks: FloatArray) -> None:
    """Raise FormatNotSupported if the curve repeats or continues outside its keys."""
    for name, beyond in (
        ("Pre-Extrapolation", ticks[0] < keys.times[0]),
        ("Post-Extrapolation", ticks[-1] > keys.times[-1]),
    ):
        record = curve.record.child(name)
        kind = record.child("Type") if record is not None and beyond else None
        if kind is not None and next(iter(kind.properties(1)), b"C") not in _CONSTANT_BEYOND:
            raise unsupported_at(curve.location, f"expected a constant {name}")


def _between(curve: FbxObject, keys: Keys, left: IntArray, along: FloatArray) -> FloatArray:
    """(n,) the values in the gaps after the keys `left` (n,); along: (n,) shares of the gaps."""
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
        raise unsupported_at(curve.location, "expected constant, linear or cubic keys")
    return result


def _cubic(curve: FbxObject, keys: Keys, left: IntArray, along: FloatArray) -> FloatArray:
    """(n,) the values on Bezier curves, as in `_between`. Raises FormatNotSupported."""
    # gaps (m,): each gap is prepared once; where (n,): the gap of each value
    gaps, where = np.unique(left, return_inverse=True)
    ends = keys.flags[gaps] | np.where(_is_cubic(keys.flags[gaps + 1]), keys.flags[gaps + 1], 0)
    if np.any(ends & _TCB):
        raise unsupported_at(curve.location, "expected no TCB keys")
    seconds = (keys.times[gaps + 1] - keys.times[gaps]) / KTIME
    right, next_left = _weights(keys, gaps)
    slopes = _slopes(keys, gaps)
    # Points of the Bezier curve: times 0, x1, x2, 1 as shares of the gap; values y0, y1, y2, y3.
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
    """(n,) the lengths of the tangents at both ends of gaps, as shares of the gap, 0 to 1."""
    bits = np.ascontiguousarray(keys.data[gaps, 2], dtype=np.float32).view(np.uint32)
    right = np.where(
        keys.flags[gaps] & _WEIGHTED_RIGHT, (bits & 0xFFFF) * WEIGHT_UNIT, USUAL_WEIGHT
    )
    left = np.where(
        keys.flags[gaps] & _WEIGHTED_NEXT_LEFT, (bits >> 16) * WEIGHT_UNIT, USUAL_WEIGHT
    )
    return np.clip(right, 0, 1), np.clip(left, 0, 1)


def _slopes(keys: Keys, gaps: IntArray) -> tuple[FloatArray, FloatArray]:
    """(n,) the slopes per second at both ends of gaps."""
    stored = np.nan_to_num(keys.data[gaps, :2].astype(np.float64), posinf=0, neginf=0)
    stored = np.clip(stored, -MAX_MAGNITUDE, MAX_MAGNITUDE)
    automatic = _is_cubic(keys.flags) & (keys.flags & _USER == 0)
    # For an automatic tangent, the file stores its bias in percent instead of a slope.
    bias = stored / 100
    start = np.where(automatic[gaps], _auto_slopes(keys, gaps, bias[:, 0]), stored[:, 0])
    end = np.where(automatic[gaps + 1], _auto_slopes(keys, gaps + 1, -bias[:, 1]), stored[:, 1])
    return start, end


def _auto_slopes(keys: Keys, at: IntArray, bias: FloatArray) -> FloatArray:
    """(n,) the slopes per second of automatic tangents at the keys `at` (n,).

    bias: (n,). A positive bias moves the slope from the mean of both gaps toward that of the right
    gap, a negative one toward that of the left gap. 1 reaches it, and more goes beyond it.
    """
    down, before = _rise_and_run(keys, np.maximum(at - 1, 0), at)
    up, after = _rise_and_run(keys, at, np.minimum(at + 1, len(keys) - 1))
    left, right = _ratio(down, before), _ratio(up, after)
    flags = keys.flags[at]
    biased_to = np.where(bias > 0, right, left)
    mean = (left + right) / 2
    slope = mean + np.abs(bias) * (biased_to - mean)
    slope = np.where(flags & _TIMED != 0, _ratio(down + up, before + after), slope)
    flat = np.minimum(np.abs(down), np.abs(up)) < _FLAT
    slope = np.where(flat & (flags & _CLAMP != 0), 0.0, slope)
    limited = _limited(slope, left / USUAL_WEIGHT, right / USUAL_WEIGHT)
    slope = np.where(flags & _PROGRESSIVE != 0, limited, slope)
    # The first and the last key have only one gap; the slope of the other one is 0 here.
    outer = (before <= 0) | (after <= 0)
    return np.where(outer, np.where(flags & _PROGRESSIVE != 0, 0.0, left + right), slope)


def _rise_and_run(keys: Keys, start: IntArray, end: IntArray) -> tuple[FloatArray, FloatArray]:
    """(n,) the difference of the values, and the seconds, between two keys."""
    rise = keys.values[end].astype(np.float64) - keys.values[start]
    return rise, (keys.times[end] - keys.times[start]) / KTIME


def _ratio(rise: FloatArray, run: FloatArray) -> FloatArray:
    """(n,) the slopes; 0 for keys at the same time."""
    return np.divide(rise, run, out=np.zeros(len(run)), where=run > 0)


def _limited(slope: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
    """(n,) slopes that are not steeper than `left` and `right`; 0 if one has another sign."""
    sign = np.where(slope < 0, -1.0, 1.0)
    limit = np.minimum(sign * left, sign * right)
    return np.asarray(sign * np.minimum(np.abs(slope), np.maximum(limit, 0)))


def _solve_bezier(x1: FloatArray, x2: FloatArray, x: FloatArray) -> FloatArray:
    """(n,) the parameters t at which cubic Bezier curves reach x (n,).

    The curves have the points 0, x1, x2 and 1, all in [0, 1], so they ascend and bisection always
    finds t. Newton's method is faster and is used if its step stays inside the bracket.
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
    """The values of cubic Bezier curves with the points y0 to y3 at the parameters t (n,)."""
    s = 1 - t
    return np.asarray(s**3 * y0 + 3 * (s**2 * t * y1 + s * t**2 * y2) + t**3 * y3)
