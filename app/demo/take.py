"""A take: one performance of a task by an actor. Takes differ a little from each other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians
from zlib import crc32

import numpy as np

from app.demo.actors import Actor
from app.demo.controls import Controls, Turn
from app.demo.curves import wobble
from app.demo.rig import Rig, build_rig
from app.numerics.arrays import FloatArray

GRAVITY = 9.81
"""m/s^2."""


@dataclass(frozen=True, slots=True)
class Take:
    """The parameters of one performance.

    draw: the random numbers of the take, the same at every run. pace: factor on speed. size: factor
    on amplitude. phase: in [0, 1), the part of the cycle at the start. heading: rad.
    """

    actor: Actor
    rig: Rig
    draw: np.random.RandomState
    pace: float
    size: float
    phase: float
    heading: float

    def clock(self, seconds: float) -> FloatArray:
        """(frames,) the times of the frames of a motion of `seconds`, in seconds."""
        return np.arange(max(2, round(seconds * self.actor.frame_rate))) / self.actor.frame_rate

    def vary(self, spread: float) -> float:
        """A random factor from 1 - spread to 1 + spread."""
        return float(self.draw.uniform(1.0 - spread, 1.0 + spread))


def prepare(actor: Actor, task: str, number: int) -> Take:
    """Take `number` (from 1) of a task by an actor."""
    # crc32 and the stream of RandomState never change, so all machines draw the same numbers.
    draw = np.random.RandomState(crc32(f"{actor.name}/{task}/{number}".encode()))
    return Take(
        actor=actor,
        rig=build_rig(actor),
        draw=draw,
        pace=actor.style.tempo * float(draw.uniform(0.95, 1.05)),
        size=actor.style.energy * float(draw.uniform(0.93, 1.07)),
        phase=float(draw.uniform(0.0, 1.0)),
        heading=float(draw.uniform(radians(-25), radians(25))),
    )


def with_body_sway(controls: Controls, take: Take, times: FloatArray) -> Controls:
    """`controls` with breathing and the small sway of a living body; times: (frames,) s."""
    draw, style = take.draw, take.actor.style
    sway = 0.006 * style.sway
    drift = np.stack(
        [wobble(times, draw, sway), np.zeros_like(times), wobble(times, draw, 0.005)], axis=-1
    )
    breath = 0.012 * np.sin(2.0 * np.pi * (0.27 * take.pace * times + take.phase))
    arms = [
        replace(
            arm,
            flex=arm.flex + wobble(times, draw, 0.025),
            abduct=arm.abduct + wobble(times, draw, 0.015),
            # the elbow must not bend backward
            elbow=np.maximum(arm.elbow + wobble(times, draw, 0.03), 0.03),
        )
        for arm in controls.arms
    ]
    return replace(
        controls,
        root=controls.root + drift,
        spine=_swayed(controls.spine, times, draw, 0.012, breath),
        head=_swayed(controls.head, times, draw, 0.03, -breath),
        arms=(arms[0], arms[1]),
        shrug=controls.shrug - breath,
    )


def _swayed(
    turn: Turn, times: FloatArray, draw: np.random.RandomState, size: float, pitch: FloatArray
) -> Turn:
    return Turn(
        yaw=turn.yaw + wobble(times, draw, size),
        pitch=turn.pitch + pitch + wobble(times, draw, 0.7 * size),
        roll=turn.roll + wobble(times, draw, 0.5 * size),
    )
