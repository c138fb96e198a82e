"""The best loop of a motion, and its blend.

A loop is a part whose end is followed well by its beginning. Of all pairs of frames at 30 Hz, that
pair is taken whose poses and velocities differ least, relative to how far the pose moves between
them: else the best loop would be a moment of standing still. Then the last frames of the loop are
blended with those before its beginning, which are turned and moved to the end of the path. So
repeats follow each other without a jump of pose or velocity, each from where the last one ended.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.deadline import check
from app.errors import TooShort
from app.kinedex_error import Place
from app.motion.editing.edited import Edited, part
from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation, continuous
from app.motion.skeleton.rotations import multiply, rotate
from app.numerics.arrays import FloatArray

BLEND_SECONDS = 0.2
"""The end of a loop that is blended, and what is needed before its beginning."""
MIN_SECONDS = 0.5
"""The shortest loop by default."""
VELOCITY_SECONDS = 0.1
"""By this time velocities are multiplied before they are compared like poses."""
MAX_SAMPLES = 3000
"""Poses that are compared with each other: more are thinned evenly."""
_LEAST_MOVED = 0.05
"""Body lengths: a pose that moves less in a loop counts as if it moved so far."""


@dataclass(frozen=True, slots=True)
class LoopCut:
    """A loop. start, end: seconds; distance: between the poses of both ends, body lengths (RMS
    over the joints, with velocities)."""

    start: float
    end: float
    distance: float


def best_loop(
    track: BodyTrack, min_seconds: float = MIN_SECONDS, max_seconds: float | None = None
) -> LoopCut:
    """The best loop of a track that lasts from `min_seconds` to `max_seconds`.

    It begins not before BLEND_SECONDS. Raises TooShort if the motion has no room for it.
    """
    step = max(1, -(-track.frames // MAX_SAMPLES))
    features = _features(track)[::step]
    rate = track.rate / step
    head, shortest = int(np.ceil(BLEND_SECONDS * rate)), max(1, int(np.ceil(min_seconds * rate)))
    longest = len(features) if max_seconds is None else int(max_seconds * rate)
    if head + shortest >= len(features) or longest < shortest:
        needed = BLEND_SECONDS + min_seconds
        message = f"expected more than {needed:.2f} s, found {track.duration:.2f} s"
        raise TooShort("The motion is too short for a loop.", places=[Place("frames", message)])
    steps = np.linalg.norm(np.diff(features[:, :1], axis=0), axis=-1).mean(axis=1)
    moved = np.concatenate([[0.0], np.cumsum(steps)])
    return _best(features, moved, rate, head, shortest, longest)


def _features(track: BodyTrack) -> FloatArray:
    """(n, 2, 39) poses in the body frame and their velocities, body lengths, RMS over joints."""
    poses = track.local.reshape(track.frames, -1)
    across = track.velocity()
    speeds = np.gradient(poses, axis=0) * track.rate * VELOCITY_SECONDS
    speeds += np.tile(across * VELOCITY_SECONDS, track.local.shape[1])
    heights = track.origin[:, 1:2] / track.body_length
    poses = poses + np.tile(np.hstack([0 * heights, heights, 0 * heights]), track.local.shape[1])
    return np.asarray(np.stack([poses, speeds], axis=1) / np.sqrt(track.local.shape[1]))


def _best(
    features: FloatArray,
    moved: FloatArray,
    rate: float,
    head: int,
    shortest: int,
    longest: int,
) -> LoopCut:
    flat = features.reshape(len(features), -1).astype(np.float32)
    best = (np.inf, head, head + shortest, 0.0)
    for start in range(head, len(flat) - shortest):
        check()
        ends = slice(start + shortest, min(start + longest, len(flat) - 1) + 1)
        distances = np.linalg.norm(flat[ends] - flat[start], axis=1)
        relative = distances / np.maximum(moved[ends] - moved[start], _LEAST_MOVED)
        chosen = int(np.argmin(relative))
        if relative[chosen] < best[0]:
            stop = start + shortest + chosen
            best = (float(relative[chosen]), start, stop, float(distances[chosen]))
    _, start, stop, distance = best
    return LoopCut(start / rate, stop / rate, distance)


def loop(edited: Edited, cut: LoopCut, track: BodyTrack) -> Edited:
    """The frames of a loop, whose last ones are blended. track: of `edited`."""
    first, stop = (round(time * edited.rate) for time in (cut.start, cut.end))
    stop = min(max(stop, first + 1), edited.frames - 1)
    count = min(round(BLEND_SECONDS * edited.rate), first, stop - first)
    before = _moved_to_end(edited, track, first, stop, count)
    after = part(edited, stop - count, stop).animation
    shares = np.arange(1, count + 1) / (count + 1)
    blended = _blended(after, before, shares * shares * (3 - 2 * shares))
    kept = part(edited, first, stop).animation
    rotations, translations = np.array(kept.rotations), np.array(kept.translations)
    rotations[len(rotations) - count :] = blended.rotations
    translations[len(translations) - count :] = blended.translations
    return edited.with_animation(replace(kept, rotations=rotations, translations=translations))


def _moved_to_end(edited: Edited, track: BodyTrack, first: int, stop: int, count: int) -> Animation:
    """The frames before `first`, moved and turned so that frame `first` is where `stop` is."""
    animation = part(edited, first - count, first).animation
    roots = np.flatnonzero(animation.skeleton.parents < 0)
    headings = edited.headings(track)
    half = (headings[stop] - headings[first]) / 2
    turn = np.array([np.cos(half), 0.0, np.sin(half), 0.0])
    hips = edited.animation.positions()[[first, stop], edited.roles[JointRole.HIPS]]
    start, end = hips * np.array([1.0, 0.0, 1.0])
    rotations, translations = np.array(animation.rotations), np.array(animation.translations)
    rotations[:, roots] = multiply(turn, animation.rotations[:, roots])
    translations[:, roots] = rotate(turn, animation.translations[:, roots] - start) + end
    return replace(animation, rotations=rotations, translations=translations)


def _blended(one: Animation, other: Animation, shares: FloatArray) -> Animation:
    """The frames between two animations; shares: (frames,) of the other."""
    weights = shares[:, None, None]
    signs = np.where(np.sum(one.rotations * other.rotations, axis=-1) < 0, -1.0, 1.0)
    turns = one.rotations * (1 - weights) + other.rotations * signs[..., None] * weights
    turns /= np.maximum(np.linalg.norm(turns, axis=-1, keepdims=True), 1e-9)
    return replace(
        one,
        rotations=continuous(turns) if len(turns) else turns,
        translations=one.translations * (1 - weights) + other.translations * weights,
    )
