"""What the world does to clips, as functions of a canonical motion.

Each keeps what the motion is and who moves: noise on the markers, jitter on the joints' angles (as
markerless capture gives), crops, other speeds, waiting, repetition, a lost first frame. Draws are
seeded by the number of the clip.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from app.motion.motion import Motion

Disturb = Callable[[Motion, int], Motion]


def noise(millimeters: float) -> Disturb:
    """White noise of this standard deviation on each coordinate of each joint."""

    def disturb(motion: Motion, seed: int) -> Motion:
        rng = np.random.default_rng(seed)
        drawn = rng.normal(0.0, millimeters / 1000, motion.positions.shape)
        return _with(motion, motion.positions + drawn)

    return disturb


def jitter(degrees: float) -> Disturb:
    """A rotation of every joint in every frame, about each axis by this standard deviation."""

    def disturb(motion: Motion, seed: int) -> Motion:
        rng = np.random.default_rng(seed)
        old = motion.positions.astype(np.float64)
        new = old.copy()
        frames, joints, _ = old.shape
        turned = np.tile(np.eye(3), (joints, frames, 1, 1))
        for joint in _from_root(motion.parents):
            drawn = Rotation.from_rotvec(np.radians(degrees) * rng.normal(size=(frames, 3)))
            parent = motion.parents[joint]
            if parent >= 0:
                bone = old[:, joint] - old[:, parent]
                new[:, joint] = new[:, parent] + np.einsum("nij,nj->ni", turned[parent], bone)
                turned[joint] = turned[parent] @ drawn.as_matrix()
            else:
                turned[joint] = drawn.as_matrix()
        return _with(motion, new)

    return disturb


def kept(first: float, last: float) -> Disturb:
    """The part of the clip between two shares of its frames."""

    def disturb(motion: Motion, seed: int) -> Motion:
        start, stop = round(first * motion.frames), round(last * motion.frames)
        return _with(motion, motion.positions[start:stop])

    return disturb


def faster(factor: float) -> Disturb:
    """Played this many times as fast; also what a wrong frame rate does."""

    def disturb(motion: Motion, seed: int) -> Motion:
        return replace(motion, frame_rate=motion.frame_rate * factor)

    return disturb


def without_first(frames: int) -> Disturb:
    """The clip without its first frames."""

    def disturb(motion: Motion, seed: int) -> Motion:
        return _with(motion, motion.positions[frames:])

    return disturb


def waiting(seconds: float) -> Disturb:
    """The person stands still in the first pose before the motion."""

    def disturb(motion: Motion, seed: int) -> Motion:
        still = np.repeat(motion.positions[:1], round(seconds * motion.frame_rate), axis=0)
        return _with(motion, np.concatenate([still, motion.positions]))

    return disturb


def repeated(motion: Motion, seed: int) -> Motion:
    """Twice in a row, the second time from where the first one ended."""
    root = int(np.flatnonzero(motion.parents < 0)[0])
    step = motion.positions[-1, root] - motion.positions[0, root]
    step[1] = 0.0
    return _with(motion, np.concatenate([motion.positions, motion.positions + step]))


def _with(motion: Motion, positions: np.ndarray) -> Motion:
    return replace(motion, positions=positions.astype(np.float32))


def _from_root(parents: np.ndarray) -> list[int]:
    """The joints, each after its parent."""
    depths = []
    for joint in range(len(parents)):
        depth, above = 0, parents[joint]
        while above >= 0:
            depth, above = depth + 1, parents[above]
        depths.append(depth)
    return np.argsort(depths, kind="stable").tolist()
