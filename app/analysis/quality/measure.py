"""All measures of a motion by name: see `definitions`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict

import numpy as np

from app.analysis.descriptors.movement_signs import cycle_of
from app.analysis.quality.definitions import NAMES
from app.analysis.quality.floor import floor_measures
from app.analysis.quality.flow import best_loop, end_speeds, jitter, turns
from app.analysis.quality.limbs import angles_of, dominance, joint_limits, ranges, self_contact
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray

Quality = Mapping[str, float | None]
"""Values by the names of `definitions.NAMES`; None for a measure that a motion does not have."""


def measure_quality(raw: BodyTrack, smooth: BodyTrack, signs: FloatArray) -> Quality:
    """The measures of a motion, at least two frames.

    raw, smooth: its track without and with smoothing. signs: (44,) of `movement_signs`, which has
    found the cycle.
    """
    turn, net_turn = turns(smooth)
    angles = angles_of(smooth)
    likeness, lag = cycle_of(signs)
    loop = best_loop(smooth)
    start_speed, end_speed = end_speeds(smooth)
    found: dict[str, float | None] = {
        **asdict(floor_measures(smooth)),
        "jitter": jitter(raw),
        "joint_limits": joint_limits(angles),
        "self_contact": self_contact(smooth),
        "turn": turn,
        "net_turn": net_turn,
        "dominance": dominance(smooth),
        "cyclicity": likeness,
        "cycle_time": lag if likeness > 0 else None,
        "loop_gap": None if loop is None else loop.gap,
        "loop_start": None if loop is None else loop.start,
        "loop_end": None if loop is None else loop.end,
        "start_speed": start_speed,
        "end_speed": end_speed,
        **ranges(angles),
    }
    return {name: _finite(found[name]) for name in NAMES}


def _finite(value: float | None) -> float | None:
    """In single precision: indexes in memory store it so, and must agree with the database."""
    return None if value is None or not math.isfinite(value) else float(np.float32(value))
