"""What a dancer does beside the poses: flourishes, nods, shrugs, and the bounce on the beat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.demo.controls import Arm, Controls
from app.demo.dances.counts import Counts
from app.numerics.arrays import FloatArray

OFTEN = 0.3
"""Ornaments for each beat."""

BOUNCE = 0.012
"""Meters up and down on each beat, of dancers who bounce."""


def ornamented(
    controls: Controls,
    times: FloatArray,
    counts: Counts,
    draw: np.random.RandomState,
    amount: float,
) -> Controls:
    """The same with small movements that are no keyposes; `amount` is a factor, 0 for none."""
    bounce = BOUNCE * amount * draw.uniform(0.0, 1.5) * float(draw.rand() < 0.6)
    beat = np.cos(2.0 * np.pi * counts.phase(times))
    root = controls.root - 0.5 * bounce * (1.0 + beat)[:, None] * [0.0, 1.0, 0.0]
    forearms = [np.zeros(len(times)), np.zeros(len(times))]
    nod, shrug = 2.0 * bounce * beat, np.zeros(len(times))
    for _ in range(int(draw.poisson(OFTEN * amount * len(counts.beats)))):
        burst = _burst(times, draw)
        kind = draw.randint(4)
        if kind < 2:
            forearms[kind] += 0.22 * burst
        elif kind == 2:
            nod = nod + 0.15 * burst
        else:
            shrug += 0.1 * burst
    arms = [_flourishing(arm, forearms[side]) for side, arm in enumerate(controls.arms)]
    return replace(
        controls,
        root=root,
        arms=(arms[0], arms[1]),
        head=replace(controls.head, pitch=controls.head.pitch + nod),
        shrug=controls.shrug + shrug,
    )


def _burst(times: FloatArray, draw: np.random.RandomState) -> FloatArray:
    """(frames,) a short vibration, at most 1, of 1.5 to 3 Hz."""
    center = draw.uniform(times[0], times[-1])
    length, rate = draw.uniform(0.15, 0.3), draw.uniform(1.5, 3.0)
    away = times - center
    return np.asarray(np.exp(-0.5 * (away / length) ** 2) * np.sin(2.0 * np.pi * rate * away))


def _flourishing(arm: Arm, curve: FloatArray) -> Arm:
    return replace(
        arm,
        elbow=np.maximum(arm.elbow + curve, 0.03),
        twist=arm.twist + 0.6 * curve,
        wrist=arm.wrist + 0.8 * curve,
    )
