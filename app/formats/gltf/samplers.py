"""The animations of a glTF file: keys, and values between keys.

A sampler has the times of keys and their values. Between keys it keeps the value (STEP), goes along
a straight line (LINEAR; for rotations along the shortest arc), or along a cubic Hermite spline.
Source: Khronos, "glTF 2.0 specification", section 3.11 and appendix C.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.gltf.accessors import Accessors
from app.formats.gltf.container import Container, Json
from app.numerics.arrays import FloatArray

MAX_CHANNELS = 500_000
"""The most channels of all animations together."""
PATHS = {"translation": 3, "rotation": 4, "scale": 3}
"""The properties of a node that move it, and their numbers."""
_ALMOST_PARALLEL = 1 - 1e-6
"""The cosine above which an arc between two quaternions is a straight line."""


@dataclass(frozen=True, slots=True)
class Sampler:
    """times: (keys,) seconds, ascending. values: (keys, n), or (keys, 3, n) for splines."""

    times: FloatArray
    values: FloatArray
    interpolation: str
    is_rotation: bool

    def at(self, seconds: FloatArray) -> FloatArray:
        """(n, numbers) float64 the values at some times (n,) in seconds."""
        last = len(self.times) - 1
        left = np.clip(np.searchsorted(self.times, seconds, side="right") - 1, 0, last)
        right = np.minimum(left + 1, last)
        span = (self.times[right] - self.times[left])[:, None]
        along = np.clip((seconds - self.times[left])[:, None] / np.where(span > 0, span, 1), 0, 1)
        if self.interpolation == "STEP":
            return self.values[left]
        if self.interpolation == "CUBICSPLINE":
            return _hermite(self.values[left], self.values[right], span, along)
        if self.is_rotation:
            return _along_arc(self.values[left], self.values[right], along)
        return np.asarray(self.values[left] * (1 - along) + self.values[right] * along)


def _hermite(start: FloatArray, end: FloatArray, span: FloatArray, along: FloatArray) -> FloatArray:
    """start, end: (n, 3, numbers) of a key: the tangent before it, its value, the one after it."""
    t, t2, t3 = along, along**2, along**3
    return np.asarray(
        (2 * t3 - 3 * t2 + 1) * start[:, 1]
        + span * (t3 - 2 * t2 + t) * start[:, 2]
        + (3 * t2 - 2 * t3) * end[:, 1]
        + span * (t3 - t2) * end[:, 0]
    )


def _along_arc(start: FloatArray, end: FloatArray, along: FloatArray) -> FloatArray:
    """(n, 4) quaternions on the shorter arcs from `start` to `end` (n, 4)."""
    cosine = np.sum(start * end, axis=-1, keepdims=True)
    end = np.where(cosine < 0, -end, end)
    cosine = np.clip(np.abs(cosine), 0, 1)
    angle = np.arccos(cosine)
    sine = np.where(cosine > _ALMOST_PARALLEL, 1.0, np.sin(angle))
    straight = cosine > _ALMOST_PARALLEL
    first = np.where(straight, 1 - along, np.sin((1 - along) * angle) / sine)
    second = np.where(straight, along, np.sin(along * angle) / sine)
    return np.asarray(first * start + second * end)


@dataclass(frozen=True, slots=True)
class Animation:
    """An animation: its name, and the entry of the sampler of each node and path."""

    name: str
    location: str
    channels: dict[tuple[int, str], Json] = field(default_factory=dict)

    def nodes(self) -> set[int]:
        """The nodes that it moves."""
        return {node for node, _ in self.channels}


def find_animations(container: Container) -> list[Animation]:
    """All animations, in the order of the file. Raises Unreadable, TooLarge."""
    found, count = [], 0
    for index, entry in enumerate(container.entries("animations")):
        location = f"animations/{index}"
        name = entry.get("name")
        shown = name[:200] if isinstance(name, str) else f"animation {index}"
        animation = Animation("".join(c for c in shown if c.isprintable()), location)
        samplers = entry.get("samplers", [])
        for node, path, sampler in _channels(entry, location):
            count += 1
            if count > MAX_CHANNELS:
                raise too_large("animations", f"expected at most {MAX_CHANNELS} channels")
            if not isinstance(samplers, list) or not 0 <= sampler < len(samplers):
                raise unreadable_at(location, f"expected a sampler, found index {sampler}")
            animation.channels[node, path] = samplers[sampler]
        found.append(animation)
    return found


def _channels(entry: Json, location: str) -> Iterator[tuple[int, str, int]]:
    """The node, the path and the index of the sampler of each channel that moves a node."""
    channels = entry.get("channels", [])
    for channel in channels if isinstance(channels, list) else ():
        target = channel.get("target") if isinstance(channel, dict) else None
        if not isinstance(target, dict) or type(channel.get("sampler")) is not int:
            raise unreadable_at(location, "expected a target and a sampler of each channel")
        node, path = target.get("node"), target.get("path")
        if type(node) is int and path in PATHS:
            yield node, path, channel["sampler"]


def key_times(accessors: Accessors, sampler: Json, location: str) -> FloatArray:
    """(keys,) the times of a sampler in seconds. Raises Unreadable."""
    if not isinstance(sampler, dict):
        raise unreadable_at(location, "expected a sampler")
    with np.errstate(invalid="ignore"):  # a signaling NaN would give a warning
        times = accessors.array(sampler.get("input"))[:, 0].astype(np.float64)
    good = len(times) and bool(np.isfinite(times).all()) and bool((np.diff(times) >= 0).all())
    if not good or np.abs(times).max() > MAX_MAGNITUDE:
        raise unreadable_at(location, "expected times of keys in ascending order")
    return times


def read_sampler(accessors: Accessors, sampler: Json, path: str, location: str) -> Sampler:
    """A sampler. Raises Unreadable."""
    times = key_times(accessors, sampler, location)
    kind = sampler.get("interpolation", "LINEAR")
    if kind not in ("LINEAR", "STEP", "CUBICSPLINE"):
        raise unreadable_at(location, f"expected an interpolation, found {str(kind)[:40]!r}")
    with np.errstate(invalid="ignore"):  # a signaling NaN would give a warning
        values = accessors.array(sampler.get("output")).astype(np.float64)
    shape = (len(times), 3, PATHS[path]) if kind == "CUBICSPLINE" else (len(times), PATHS[path])
    if values.size != np.prod(shape) or values.shape[1] != PATHS[path]:
        raise unreadable_at(location, f"expected {len(times)} values of {path}")
    # The numbers of a broken file may be NaN, for which this is False.
    if values.size and not np.abs(values).max() <= MAX_MAGNITUDE:
        raise unreadable_at(location, f"expected values within ±{MAX_MAGNITUDE:g}")
    return Sampler(times, values.reshape(shape), str(kind), path == "rotation")
