"""How smoothly a synthesized motion moves, and how firmly its feet stand, beside real takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.frame.foot_contact import FEET, skating
from app.motion.motion import Motion
from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.store.clips import repository as clips
from app.store.clips.record import ClipState

MAX_TAKES = 8
"""Largest number of real takes that are measured."""

MAX_RATIO = 2.0
"""A motion with more than this times the jerk or the foot skate of real takes has a warning."""

MIN_SKATE = 0.1
"""Meters per second. Feet that slide less than this hardly seem to slide."""

MIN_JERK = 30.0
"""Meters per second cubed. With less, the motion hardly moves."""


@dataclass(frozen=True, slots=True)
class Movement:
    """skate: mean horizontal speed of feet that are low, m/s; jerk: see `jerk_of`."""

    skate: float
    jerk: float


@dataclass(frozen=True, slots=True)
class Doubt:
    """A reason not to trust a motion.

    code: "jerky" or "feet_slide"; detail: in words; value, real: of the motion and of real takes,
    in m/s³ and in m/s.
    """

    code: str
    detail: str
    value: float
    real: float


def movement_of(motion: Motion) -> Movement:
    """The movement of a motion, measured at ANALYSIS_RATE, so that frame rates do not matter."""
    positions = resample(
        motion.role_positions().astype(np.float64), motion.frame_rate, ANALYSIS_RATE
    )
    return Movement(skating(positions[:, FEET], ANALYSIS_RATE), jerk_of(positions, ANALYSIS_RATE))


def jerk_of(positions: FloatArray, rate: float) -> float:
    """The root mean square, over frames and joints, of the jerk, m/s³; 0 for under four frames.

    positions: (n, joints, 3) meters. The jerk is the third derivative of a position.
    """
    if len(positions) < 4:
        return 0.0
    jerks = np.diff(positions, 3, axis=0) * rate**3
    return float(np.sqrt(np.square(jerks).sum(axis=-1).mean()))


def real_movement(lib: Library, clip_ids: Sequence[str]) -> Movement | None:
    """The mean movement of at most MAX_TAKES of these clips, evenly chosen; None if none is left.

    Clips that were removed, or that are not ready, do not count.
    """
    with lib.store.read() as tx:
        found = clips.get_many(tx, list(clip_ids))
    ready = [found[one] for one in clip_ids if one in found]
    ready = [clip for clip in ready if clip.state is ClipState.READY]
    if not ready:
        return None
    places = np.linspace(0, len(ready) - 1, min(len(ready), MAX_TAKES)).round().astype(int)
    measured = [movement_of(load_motion(lib, ready[place])) for place in places]
    return Movement(
        float(np.mean([one.skate for one in measured])),
        float(np.mean([one.jerk for one in measured])),
    )


def doubts(own: Movement, real: Movement | None, task: str) -> tuple[Doubt, ...]:
    """The doubts about a motion of a task, beside the real takes of the task."""
    if real is None:
        return ()
    found = []
    if own.jerk > MAX_RATIO * max(real.jerk, MIN_JERK):
        words = f"The motion is jerky: {own.jerk:.0f} m/s³, real takes of {task} {real.jerk:.0f}"
        found.append(Doubt("jerky", f"{words}.", own.jerk, real.jerk))
    if own.skate > MAX_RATIO * max(real.skate, MIN_SKATE):
        words = f"Feet slide: {own.skate:.2f} m/s, real takes of {task} {real.skate:.2f}"
        found.append(Doubt("feet_slide", f"{words}.", own.skate, real.skate))
    return tuple(found)
