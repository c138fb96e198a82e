"""Small movements between the poses: of forearms, head and shoulders, and a bounce on the beat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.demo.controls import Arm, Controls
from app.demo.dances.counts import Counts
from app.numerics.arrays import FloatArray

ORNAMENTS_PER_BEAT = 0.3
"""The mean number."""

BOUNCE = 0.012
"""Meters by which the pelvis moves up and down on each beat, if a dancer bounces."""


def with_ornaments(
    controls: Controls,
    times: FloatArray,
    counts: Counts,
    draw: np.random.RandomState,
    amount: float,
) -> Controls:
    """`controls` with small movements that are not keyposes.

    times: (frames,) s. amount: factor on their number and on the bounce; 0: none.
    """
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
    length, rate = draw.uniform(0.15, 0.3), draw.uniform(1.5, 3.0)
    away = times - center
    return np.asarray(np.exp(-0.5 * (away / length) ** 2) * np.sin(2.0 * np.pi * rate * away))


def _with_vibration(arm: Arm, curve: FloatArray) -> Arm:
    return replace(
        arm,
        elbow=np.maximum(arm.elbow + curve, 0.03),
        twist=arm.twist + 0.6 * curve,
        wrist=arm.wrist + 0.8 * curve,
    )
