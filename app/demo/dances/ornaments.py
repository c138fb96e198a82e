"""Small movements between the poses: of forearms, head and shoulders, and a bounce on the beat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.demo.controls import Arm, Controls
from app.demo.dances.counts import Counts, Manner
from app.numerics.arrays import FloatArray

ORNAMENTS_PER_BEAT = 0.3
"""The mean number."""

BOUNCE = 0.012
"""Meters by which the pelvis moves up and down on each beat, if a dancer bounces."""

HIT_SIZE, HIT_LENGTH, HIT_RATE = 0.3, 0.1, 2.0
"""Radians, seconds (standard deviation) and Hz of the vibration with which a dancer hits a beat."""


def with_ornaments(
    controls: Controls,
    times: FloatArray,
    counts: Counts,
    draw: np.random.RandomState,
    manner: Manner,
) -> Controls:
    """`controls` with small movements that are not keyposes, and with hits on passed poses.

    times: (frames,) s.
    """
    amount = manner.ornaments
    bounce = BOUNCE * amount * draw.uniform(0.0, 1.5) * float(draw.rand() < 0.6)
    beat = np.cos(2.0 * np.pi * counts.phase(times))
    root = controls.root - 0.5 * bounce * (1.0 + beat)[:, None] * [0.0, 1.0, 0.0]
    forearms = [np.zeros(len(times)), np.zeros(len(times))]
    nod, shrug = 2.0 * bounce * beat, np.zeros(len(times))
    for _ in range(int(draw.poisson(ORNAMENTS_PER_BEAT * amount * len(counts.beats)))):
        burst = _burst(times, draw)
        kind = draw.randint(4)
        if kind < 2:
            forearms[kind] += 0.22 * burst
        elif kind == 2:
            nod = nod + 0.15 * burst
        else:
            shrug += 0.1 * burst
    for moment in counts.moments:
        if manner.accents and not moment.is_held and draw.rand() < manner.accents:
            hit = HIT_SIZE * _vibration(times, moment.time, HIT_LENGTH, HIT_RATE)
            forearms = [forearm + hit for forearm in forearms]
            nod = nod + 0.5 * hit
    arms = [_with_vibration(arm, forearms[side]) for side, arm in enumerate(controls.arms)]
    return replace(
        controls,
        root=root,
        arms=(arms[0], arms[1]),
        head=replace(controls.head, pitch=controls.head.pitch + nod),
        shrug=controls.shrug + shrug,
    )


def _burst(times: FloatArray, draw: np.random.RandomState) -> FloatArray:
    """(frames,) a short vibration of 1.5 to 3 Hz at a random time; its amplitude is 1."""
    center = draw.uniform(times[0], times[-1])
    return _vibration(times, center, draw.uniform(0.15, 0.3), draw.uniform(1.5, 3.0))


def _vibration(times: FloatArray, center: float, length: float, rate: float) -> FloatArray:
    """(frames,) a vibration of `rate` Hz about `center`, fastest there; its amplitude is 1.

    times: (frames,) s. length: the standard deviation of its duration, s.
    """
    away = times - center
    return np.asarray(np.exp(-0.5 * (away / length) ** 2) * np.sin(2.0 * np.pi * rate * away))


def _with_vibration(arm: Arm, curve: FloatArray) -> Arm:
    return replace(
        arm,
        elbow=np.maximum(arm.elbow + curve, 0.03),
        twist=arm.twist + 0.6 * curve,
        wrist=arm.wrist + 0.8 * curve,
    )
