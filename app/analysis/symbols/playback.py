"""Generation of the motion that a motion symbol represents (Takano, section 2.1 and fig. 6).

The mean trajectory follows the expected path of the symbol. Each state lasts as long as expected,
and its mean is the value at the middle of that time. Between two middles, the channels are
interpolated by monotone cubics, which never overshoot. The standard deviations are interpolated in
the same way.

The 26 channels do not describe a whole pose. So each state also gets the mean of the 39 coordinates
of the 13 joint roles in the body frame, weighted by the probability of the state in each frame of
the clip to which the symbol was fitted. This is the M-step that also gave the channels' means. A
mean of different poses shortens limbs, so limbs are scaled back to the body's lengths. Place and
heading follow from the generated speeds, yaw rate and height, never from the clip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.symbols.channels import CHANNEL_SCALES, CHANNELS, symbol_features
from app.motion.frame.body_frame import BodyTrack, turned
from app.motion.roles.joint_roles import SUN_PARENTS
from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM

_HEIGHT, _LEFT, _FORWARD, _YAW = (
    CHANNELS.index(name) for name in ("height", "speed_left", "speed_forward", "yaw_rate")
)


def _steps_to_root(joint: int) -> int:
    return 0 if SUN_PARENTS[joint] < 0 else 1 + _steps_to_root(SUN_PARENTS[joint])


_OUTWARD = sorted(range(len(SUN_PARENTS)), key=_steps_to_root)[1:]
"""Every joint but the root, each after its parent."""


@dataclass(frozen=True, slots=True)
class SymbolMotion:
    """The motion that a symbol generates: n frames at `rate` Hz.

    means, spreads: (n, 26) the CHANNELS in their units (cosines, body lengths, body lengths / s,
    radians / s) and their standard deviations. positions: (n, 13, 3) meters, in the world, Y up,
    floor at 0. The motion starts above the origin and faces along Z.
    """

    means: FloatArray
    spreads: FloatArray
    positions: FloatArray
    rate: float


def symbol_motion(symbol: GaussianHMM, track: BodyTrack) -> SymbolMotion:
    """The motion that `symbol` generates.

    track: that of the clip to which the symbol was fitted. The result is deterministic. A symbol
    of one state holds one pose while it travels.
    """
    from app.numerics.hmm.sampling import occupancy  # hmmlearn is slow to load

    weights = occupancy(symbol, symbol_features(track))
    poses = _means_by_state(track.local.reshape(track.frames, -1), weights)
    times, frames = _state_middles(symbol)
    # the means are in units of CHANNEL_SCALES
    scaled = _interpolated(times, symbol.means * CHANNEL_SCALES, frames)
    spreads = _interpolated(times, np.sqrt(symbol.variances) * CHANNEL_SCALES, frames)
    local = _with_lengths(_interpolated(times, poses, frames).reshape(frames, -1, 3), track.local)
    positions = _world_positions(local, scaled, track.body_length, track.rate)
    return SymbolMotion(scaled, spreads, positions, track.rate)


def _means_by_state(rows: FloatArray, weights: FloatArray) -> FloatArray:
    """(K, d) the means of `rows` (T, d) weighted by `weights` (T, K).

    A state without weight gets the mean of all rows.
    """
    visited = weights.sum(axis=0)
    share = weights / np.maximum(visited, 1e-9)
    return np.where(visited[:, None] > 1e-6, share.T @ rows, rows.mean(axis=0))


def _state_middles(symbol: GaussianHMM) -> tuple[FloatArray, int]:
    """(K,) the middle frame of each state on the expected path, and the length of the path."""
    frames_of_state = np.bincount(symbol.expected_path(), minlength=symbol.states)
    ends = np.cumsum(frames_of_state)
    return ends - (frames_of_state + 1) / 2, int(ends[-1])


def _interpolated(times: FloatArray, values: FloatArray, frames: int) -> FloatArray:
    """(frames, d) monotone cubics through `values` (K, d) at `times` (K,), constant outside."""
    if len(times) == 1:
        return np.repeat(values, frames, axis=0)
    inside = np.clip(np.arange(frames), times[0], times[-1])
    return np.asarray(scipy.interpolate.PchipInterpolator(times, values, axis=0)(inside))


def _with_lengths(poses: FloatArray, like: FloatArray) -> FloatArray:
    """(n, 13, 3) `poses` with the length of each limb set to its median in `like` (m, 13, 3)."""
    result = poses.copy()
    for joint in _OUTWARD:
        parent = SUN_PARENTS[joint]
        length = float(np.median(np.linalg.norm(like[:, joint] - like[:, parent], axis=1)))
        line = poses[:, joint] - poses[:, parent]
        reach = np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-6)
        result[:, joint] = result[:, parent] + line * (length / reach)
    return result


def _world_positions(
    local: FloatArray, channels: FloatArray, body_length: float, rate: float
) -> FloatArray:
    """(n, 13, 3) the body-frame poses `local` in the world, meters.

    channels: (n, 26) give the speeds, the yaw rate and the height.
    """
    heading = _summed(channels[:, _YAW]) / rate
    zero = np.zeros(len(channels))
    speeds = np.stack([channels[:, _LEFT], zero, channels[:, _FORWARD]], axis=1)
    position = _summed(turned(speeds[:, None], heading)[:, 0]) / rate
    position[:, 1] = channels[:, _HEIGHT]
    return (turned(local, heading) + position[:, None]) * body_length


def _summed(rates: FloatArray) -> FloatArray:
    """The running integral of `rates` by trapezoids, in frames; 0 at the first frame."""
    steps = (rates[1:] + rates[:-1]) / 2
    return np.concatenate([np.zeros_like(rates[:1]), np.cumsum(steps, axis=0)])
