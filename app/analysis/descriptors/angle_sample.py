"""The angle sample: a clip's joint angles as one vector, Vasilescu's T time samples.

Like the motion sample, it covers the mean gait cycle if there are gait cycles, else the whole
clip. The net turn and the mean speed follow, because joint angles do not contain them.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.joint_angles import joint_angles
from app.analysis.descriptors.motion_sample import SAMPLES, turn_and_speed
from app.motion.frame.body_frame import BodyTrack
from app.motion.frame.gait import exact_gait_cycles
from app.motion.skeleton.resampling import resample_to, sample_at
from app.numerics.arrays import FloatArray


def angle_sample(track: BodyTrack, cycles: list[tuple[float, float]] | None = None) -> FloatArray:
    """(642,) float32: 32 x 20 angles (radians), net turn, mean speed, as in the motion sample.

    cycles: `exact_gait_cycles(track)`, if the caller has them. The track is a smooth one
    (`smooth_track`), so its angles can be sampled at 32 phases of a gait cycle without a filter.
    """
    angles = joint_angles(track.positions, track.rate)
    cycles = exact_gait_cycles(track) if cycles is None else cycles
    if cycles:
        phases = np.arange(SAMPLES) / SAMPLES
        read = [sample_at(angles, start + (end - start) * phases) for start, end in cycles]
        sampled = np.mean(read, axis=0)
    else:
        sampled = resample_to(angles, SAMPLES)
    parts = [np.ravel(sampled), turn_and_speed(track)]
    return np.asarray(np.concatenate(parts), dtype=np.float32)
