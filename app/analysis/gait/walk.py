"""What gait analysis needs of a motion: hips, ankles and toes over time, and where they go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.errors import NoGait
from app.kinedex_error import Place
from app.motion.frame.posed_start import without_posed_start
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.smoothing import low_passed
from app.numerics.arrays import FloatArray

SIDES = ("left", "right")

PROGRESS_SPAN = 1.0
"""Seconds, about one stride: the direction of progress is that of the hips' way in this time."""

CUT_OFF = 6.0
"""Hz: the usual cut-off of gait laboratories, the same for all clips so that they compare."""

MIN_RATE = 15.0
"""Hz. With fewer frames per second, a foot strike is not found within a tenth of a stride."""

_ACROSS_FLOOR = [0, 2]


@dataclass(frozen=True, slots=True)
class Walk:
    """A motion as gait analysis sees it: n frames, filtered at 6 Hz, without a posed start.

    hips: (n, 3) meters. leftward: (n, 2) X and Z from the right to the left knee. ankles: (n, 3)
    by side. toes: (n, 3) by side, those of the ankle if the skeleton has no toes. progress: (n, 2)
    unit vector of the local direction of progress; NaN where the hips stay. leg_length: meters.
    rate: Hz. start: seconds from the beginning of the clip to the first frame here.
    """

    hips: FloatArray
    leftward: FloatArray
    ankles: dict[str, FloatArray]
    toes: dict[str, FloatArray]
    progress: FloatArray
    leg_length: float
    rate: float
    start: float

    def relative(self, points: FloatArray) -> FloatArray:
        """(n,) meters by which `points` (n, 3) are ahead of the hips along the progress."""
        away = (points - self.hips)[:, _ACROSS_FLOOR]
        return np.asarray(np.sum(away * self.progress, axis=1))

    def on_floor(self, points: FloatArray, times: FloatArray) -> FloatArray:
        """(k, 2) X and Z of `points` (n, 3) at `times` (k,), seconds of the clip."""
        return np.stack([self.at(points[:, axis], times) for axis in _ACROSS_FLOOR], axis=-1)

    def at(self, values: FloatArray, times: FloatArray) -> FloatArray:
        """(k,) `values` (n,) at `times` (k,), seconds of the clip."""
        last = len(values) - 1
        frames = np.clip((np.asarray(times) - self.start) * self.rate, 0, last)
        before = np.minimum(frames.astype(np.int64), max(last - 1, 0))
        share = frames - before
        return np.asarray(
            (1 - share) * values[before] + share * values[np.minimum(before + 1, last)]
        )

    def apart(self, times: FloatArray) -> FloatArray:
        """(k,) meters between the ankles along the progress at `times` (k,), 0 or more."""
        left, right = (self.on_floor(self.ankles[side], times) for side in SIDES)
        ahead = np.stack([self.at(self.progress[:, axis], times) for axis in (0, 1)], axis=-1)
        return np.asarray(np.abs(np.sum((left - right) * ahead, axis=-1)))


def walk_of(motion: Motion) -> Walk:
    """The walk in `motion`. Raises NoGait for a skeleton without ankles or a rate below
    MIN_RATE."""
    lacking = [f"{side}_foot" for side in SIDES if JointRole(f"{side}_foot") not in motion.roles]
    if lacking:
        raise NoGait(
            f"The skeleton has no joint for: {', '.join(lacking)}.",
            places=[Place(f"roles.{role}", "expected a joint, found none") for role in lacking],
        )
    if motion.frame_rate < MIN_RATE:
        message = f"expected at least {MIN_RATE:g} Hz, found {motion.frame_rate:g}"
        raise NoGait(
            f"The frame rate is too low for gait analysis: {message}.",
            places=[Place("frame_rate", message)],
        )
    moving = without_posed_start(motion)
    hips = _track(moving, JointRole.HIPS)
    left, right = (_track(moving, JointRole(f"{side}_knee")) for side in SIDES)
    ankles = {side: _track(moving, JointRole(f"{side}_foot")) for side in SIDES}
    toes = {
        side: _track(moving, role) if (role := JointRole(f"{side}_toes")) in motion.roles else foot
        for side, foot in ankles.items()
    }
    return Walk(
        hips=hips,
        leftward=(left - right)[:, _ACROSS_FLOOR],
        ankles=ankles,
        toes=toes,
        progress=_progress(hips[:, _ACROSS_FLOOR], motion.frame_rate),
        leg_length=_leg_length(moving),
        rate=motion.frame_rate,
        start=(motion.frames - moving.frames) / motion.frame_rate,
    )


def _track(motion: Motion, role: JointRole) -> FloatArray:
    positions = motion.positions[:, motion.roles[role]].astype(np.float64)
    return low_passed(positions, motion.frame_rate, CUT_OFF)


def _progress(hips: FloatArray, rate: float) -> FloatArray:
    """(n, 2) the unit vector from where the hips (n, 2) were to where they will be."""
    half = max(1, round(0.5 * PROGRESS_SPAN * rate))
    every = np.arange(len(hips))
    way = hips[np.minimum(every + half, len(hips) - 1)] - hips[np.maximum(every - half, 0)]
    length = np.linalg.norm(way, axis=1, keepdims=True)
    return np.asarray(np.where(length > 1e-6, way / np.maximum(length, 1e-6), np.nan))


def _leg_length(motion: Motion) -> float:
    """Median length of thigh plus shank, meters; a thigh without hip joint begins at the hips."""
    lengths = []
    for side in SIDES:
        hip = motion.roles.get(JointRole(f"{side}_upper_leg"), motion.roles[JointRole.HIPS])
        chain = [hip, *(motion.roles[JointRole(f"{side}_{part}")] for part in ("knee", "foot"))]
        bones = np.diff(motion.positions[:, chain].astype(np.float64), axis=1)
        lengths.append(float(np.median(np.linalg.norm(bones, axis=-1).sum(axis=1))))
    return float(np.mean(lengths))
