"""Long motions that are joined from short ones, for tests of searches in windows.

All bodies are positions (frames, 13, 3) in meters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_length, body_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.resampling import sample_at
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, turned_about_y
from tests.formats.npz.files import npz

GAP_SECONDS = 0.6
"""Time from the end of one part to the start of the next, seconds."""

HIPS = SUN_ROLES.index(JointRole.HIPS)


@dataclass(frozen=True)
class Stream:
    """A long motion. rate: Hz; spans: start and end of each part, seconds."""

    body: FloatArray
    rate: float
    spans: tuple[tuple[float, float], ...]


def joined(parts: Sequence[FloatArray], rate: float, gap: float = GAP_SECONDS) -> Stream:
    """The parts one after the other. Each is turned and moved to continue where the last ended.

    In the gap, every joint follows the cubic that continues both movements.
    """
    pieces: list[FloatArray] = [parts[0]]
    firsts, count = [0], len(parts[0])
    frames = max(2, round(gap * rate))
    for part in parts[1:]:
        moved = _continuing(pieces[-1], part, rate, gap)
        pieces += [_bridge(pieces[-1], moved, frames), moved]
        firsts.append(count + frames)
        count = firsts[-1] + len(moved)
    spans = [(f / rate, (f + len(p)) / rate) for f, p in zip(firsts, parts, strict=True)]
    return Stream(np.concatenate(pieces), rate, tuple(spans))


def warped(body: FloatArray, factor: float, bend: float = 0.0) -> FloatArray:
    """`body` with `factor` times its frames; bend: relative change of its speed (0.1: 10 %)."""
    share = np.linspace(0.0, 1.0, max(2, round(len(body) * factor)))
    share = share + bend * np.sin(2 * np.pi * share) / (2 * np.pi)
    return sample_at(body, share * (len(body) - 1))


def at_rate(body: FloatArray, rate: float, other: float) -> FloatArray:
    """`body` with the frame rate `rate`, resampled at the frame rate `other` (Hz)."""
    times = np.arange(int((len(body) - 1) / rate * other + 1e-6) + 1) * (rate / other)
    return sample_at(body, times)


def of_size(body: FloatArray, length: float = 1.1) -> FloatArray:
    """`body` scaled to a body length (torso, neck to head and shin) in meters."""
    return body * (length / body_length(motion_of(body)))


def _continuing(before: FloatArray, part: FloatArray, rate: float, gap: float) -> FloatArray:
    """`part`, turned and moved along the ground to the end of a gap of `gap` seconds."""
    turned = turned_about_y(part, _heading(before[-2:], rate) - _heading(part[:2], rate))
    way = (before[-1, HIPS] - before[-2, HIPS]) + (turned[1, HIPS] - turned[0, HIPS])
    target = before[-1, HIPS] + way * (rate * gap / 2)
    return turned + (target - turned[0, HIPS]) * [1.0, 0.0, 1.0]


def _heading(two: FloatArray, rate: float) -> float:
    return float(body_track(motion_of(two, 30.0)).heading[-1])


def _bridge(before: FloatArray, after: FloatArray, frames: int) -> FloatArray:
    """(frames, 13, 3) m between two bodies: cubic Hermite splines with the speeds of both ends."""
    steps = frames + 1
    u = (np.arange(1, steps) / steps)[:, None, None]
    leave, arrive = (before[-1] - before[-2]) * steps, (after[1] - after[0]) * steps
    rise = after[0] - before[-1]
    bend = (leave - rise) * (1 - u) + (rise - arrive) * u
    return np.asarray(before[-1] + u * rise + u * (1 - u) * bend)


def body_of(content: bytes, frame_rate: float | None = None) -> FloatArray:
    """The body in a motion file, (frames, 13, 3) m, at 30 Hz and scaled by `of_size`."""
    motion = canonicalize(read_recording(content), frame_rate=frame_rate)
    return of_size(body_track(motion).positions)


def npz_of(body: FloatArray, rate: float) -> bytes:
    """A body as an NPZ file."""
    return npz(
        positions=body.astype(np.float32),
        joint_names=np.array([role.value for role in SUN_ROLES]),
        frame_rate=np.float64(rate),
        unit=np.str_("m"),
    )
