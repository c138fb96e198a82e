"""Common parts of the tasks that a performer does on one spot: keys of the whole body, and the end.

A task is written for the right side. The performance of a left-handed actor is its mirror image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from app.demo.controls import Controls, along_arc, mirrored, standing_controls
from app.demo.keys import (
    ArmKey,
    FootKey,
    OffsetKey,
    TurnKey,
    arm_curves,
    foot_curves,
    offset_curve,
    turn_curves,
)
from app.demo.performance import Performance
from app.demo.posing import lowered_to_reach
from app.demo.rig import LEFT, RIGHT
from app.demo.take import Take
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class UpperBodyKeys:
    """Keys of the parts above the legs.

    arms: left and right. shrug: radians by which the clavicles rise.
    """

    pelvis: Sequence[TurnKey]
    spine: Sequence[TurnKey]
    head: Sequence[TurnKey]
    arms: tuple[Sequence[ArmKey], Sequence[ArmKey]]
    shrug: float = 0.0


@dataclass(frozen=True, slots=True)
class BodyKeys:
    """Keys of the whole body; root: offsets of the pelvis. feet: left and right."""

    root: Sequence[OffsetKey]
    feet: tuple[Sequence[FootKey], Sequence[FootKey]]
    upper_body: UpperBodyKeys


@dataclass(frozen=True, slots=True)
class Smoothing:
    """Seconds (standard deviation) by which the curves of each part are smoothed."""

    pelvis: float
    spine: float
    head: float
    arms: float
    root: float = 0.0


def keyed_performance(
    take: Take, times: FloatArray, keys: BodyKeys, smoothing: Smoothing
) -> Performance:
    """A standing performance whose curves go through `keys`; times: (frames,) s."""
    rest = standing_controls(take.actor, take.rig, len(times))
    left, right = (
        foot_curves(times, foot, foot_keys)
        for foot, foot_keys in zip(rest.feet, keys.feet, strict=True)
    )
    controls = replace(
        rest, root=offset_curve(times, rest.root, keys.root, smoothing.root), feet=(left, right)
    )
    controls = with_upper_body(times, controls, keys.upper_body, smoothing)
    return standing_performance(take, times, controls)


def with_upper_body(
    times: FloatArray, controls: Controls, keys: UpperBodyKeys, smoothing: Smoothing
) -> Controls:
    """`controls` with the parts above the legs moved through `keys`; times: (frames,) s."""
    left, right = (
        arm_curves(times, controls.arms[side], keys.arms[side], smoothing.arms)
        for side in (LEFT, RIGHT)
    )
    return replace(
        controls,
        pelvis=turn_curves(times, controls.pelvis, keys.pelvis, smoothing.pelvis),
        spine=turn_curves(times, controls.spine, keys.spine, smoothing.spine),
        head=turn_curves(times, controls.head, keys.head, smoothing.head),
        arms=(left, right),
        shrug=controls.shrug + keys.shrug,
    )


def standing_performance(
    take: Take,
    times: FloatArray,
    controls: Controls,
    *,
    is_one_sided: bool = True,
    keyposes: tuple[float, ...] = (),
    beats: tuple[float, ...] = (),
) -> Performance:
    """A performance on one spot: the feet within reach, the actor's stronger side, the heading.

    is_one_sided: whether the task uses one side, so that left-handed actors mirror it.
    """
    controls = lowered_to_reach(controls, take.rig, times)
    if is_one_sided and take.actor.left_handed:
        controls = mirrored(controls)
    return Performance(times, along_arc(controls, take.heading, 0.0), keyposes, beats)
