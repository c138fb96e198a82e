"""The spatio-temporal parameters of gait, each with its unit and its definition."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from app.analysis.gait.strides import Stride


@dataclass(frozen=True, slots=True)
class GaitParameter:
    """One parameter of a stride.

    name: ends with its unit. definition: what it measures. of: its value; NaN where the stride does
    not determine it.
    """

    name: str
    definition: str
    of: Callable[[Stride], float]


def _in_walks(value: Callable[[Stride], float]) -> Callable[[Stride], float]:
    """`value`, but NaN for a run: the method does not find when a running foot leaves the floor."""
    return lambda stride: math.nan if stride.is_run else value(stride)


def _percent(seconds: Callable[[Stride], float]) -> Callable[[Stride], float]:
    return _in_walks(lambda stride: 100.0 * seconds(stride) / stride.time)


PARAMETERS: tuple[GaitParameter, ...] = (
    GaitParameter(
        "cadence_steps_per_min",
        "two steps per stride, divided by the stride time",
        lambda stride: 120.0 / stride.time,
    ),
    GaitParameter(
        "speed_m_per_s",
        "stride length divided by stride time",
        lambda stride: stride.length / stride.time,
    ),
    GaitParameter(
        "stride_time_s",
        "from a foot strike to the next strike of the same foot",
        lambda stride: stride.time,
    ),
    GaitParameter(
        "stride_length_m",
        "distance on the floor between the places of the ankle at these two strikes",
        lambda stride: stride.length,
    ),
    GaitParameter(
        "step_time_s",
        "from the strike of the other foot to the next strike of this foot (a left step ends with "
        "the strike of the left foot)",
        lambda stride: stride.step_time,
    ),
    GaitParameter(
        "step_length_m",
        "distance between the places of the two ankles at these two strikes, along the line of the "
        "stride",
        lambda stride: stride.step_length,
    ),
    GaitParameter(
        "step_width_m",
        "distance of the other ankle's place from the line of the stride; negative if feet cross",
        lambda stride: stride.step_width,
    ),
    GaitParameter(
        "stance_time_s",
        "from the foot strike to the foot off",
        _in_walks(lambda stride: stride.stance_time),
    ),
    GaitParameter(
        "swing_time_s",
        "from the foot off to the next foot strike",
        _in_walks(lambda stride: stride.time - stride.stance_time),
    ),
    GaitParameter(
        "stance_pct", "stance time in percent of the stride time",
        _percent(lambda stride: stride.stance_time),
    ),
    GaitParameter(
        "swing_pct", "swing time in percent of the stride time",
        _percent(lambda stride: stride.time - stride.stance_time),
    ),
    GaitParameter(
        "double_support_pct",
        "time with both feet on the floor, at the beginning and the end of the stance together, in "
        "percent of the stride time",
        _percent(lambda stride: stride.double_support_time),
    ),
    GaitParameter(
        "single_support_pct",
        "stance without double support, in percent of the stride time",
        _percent(lambda stride: stride.stance_time - stride.double_support_time),
    ),
)  # fmt: skip


def explained() -> str:
    """The definitions as lines of Markdown."""
    return "\n".join(f"- `{one.name}`: {one.definition}" for one in PARAMETERS)
