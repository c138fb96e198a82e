"""The motion sample: a clip as one vector of fixed length, to recognize person and task.

It holds 32 poses in the body frame. They cover the mean gait cycle if there are gait cycles, else
the whole clip. Cycles start at the forward swing of the left foot, so that phases agree. The net
turn and the mean speed of the whole clip follow.
"""

from __future__ import annotations

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.motion.frame.gait import exact_gait_cycles
from app.motion.skeleton.resampling import low_pass, resample_to, sample_at
from app.numerics.arrays import FloatArray

SAMPLES = 32
"""The number of poses in a sample."""

MARGIN_FRAMES = 12
"""Frames that are kept on both sides of a cycle. The low-pass filter needs fewer."""

SAMPLE_LENGTH = SAMPLES * 13 * 3 + 2
"""The length of a motion sample: 1250."""


def motion_sample(track: BodyTrack, cycles: list[tuple[float, float]] | None = None) -> FloatArray:
    """(1250,) float32: 32 x 13 x 3 positions (body lengths), net turn, mean speed.

    The net turn is the asinh of radians: close to the true value up to a quarter turn, while many
    turns do not outweigh all other numbers. The speed is the horizontal speed of the hips, in
    body lengths per second. cycles: `exact_gait_cycles(track)`, if the caller has them.
    """
    cycles = exact_gait_cycles(track) if cycles is None else cycles
    poses = mean_cycle(track, cycles) if cycles else resample_to(track.local, SAMPLES)
    parts = [poses.ravel(), turn_and_speed(track)]
    return np.asarray(np.concatenate(parts), dtype=np.float32)


def turn_and_speed(track: BodyTrack) -> FloatArray:
    """(2,) asinh of the net turn in radians, mean horizontal speed in body lengths per second."""
    turn = np.arcsinh(track.heading[-1] - track.heading[0])
    return np.array([turn, np.hypot(*track.velocity()[:, [0, 2]].T).mean()])


def mean_cycle(track: BodyTrack, cycles: list[tuple[float, float]]) -> FloatArray:
    """(32, 13, 3) the mean over `cycles` of the body-frame positions at 32 phases of each cycle.

    cycles: start and end in frames, at least one.
    """
    return mean_over_cycles(track.local, cycles)[:-1]


def mean_over_cycles(values: FloatArray, cycles: list[tuple[float, float]]) -> FloatArray:
    """(33, ...) the mean over `cycles` of `values` (n, ...), at 32 phases of each and at its end.

    cycles: start and end in frames, at least one.
    """
    return np.asarray(np.mean([_phases(values, *cycle) for cycle in cycles], axis=0))


def _phases(values: FloatArray, start: float, end: float) -> FloatArray:
    """(33, ...) `values` (n, ...) at 33 phases from `start` to `end`, in frames."""
    # to filter the whole clip for each cycle would take time in proportion to clip and cycles
    first = max(0, int(start) - MARGIN_FRAMES)
    smooth = low_pass(values[first : int(end) + MARGIN_FRAMES + 1], (end - start) / SAMPLES)
    return sample_at(smooth, start - first + (end - start) * np.arange(SAMPLES + 1) / SAMPLES)
