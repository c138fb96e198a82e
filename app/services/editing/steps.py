"""The steps of an edit: what a client asks, and how a step changes a motion and its times."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from typing import Any

from app.deadline import check
from app.motion.editing.edited import Edited, in_place, part
from app.motion.editing.loop import MIN_SECONDS, best_loop, loop
from app.motion.editing.mirror import mirror
from app.motion.frame.body_frame import ANALYSIS_RATE, MIN_FRAMES
from app.services.fields import bad_field
from app.services.views.frame_rates import MAX_FPS, MAX_POSITIONS, MIN_FPS

MAX_STEPS = 20
"""Steps of one edit."""
MIN_PART = MIN_FRAMES / ANALYSIS_RATE
"""Seconds: the shortest part, since shorter clips cannot be analyzed."""
MAX_LOOP_SECONDS = 3600.0


class EditKind(StrEnum):
    """The kinds of edits."""

    CUT = "cut"
    """Keep the part from `start` to `end`."""
    MIRROR = "mirror"
    """Exchange left and right."""
    RESAMPLE = "resample"
    """Another frame rate, `fps`."""
    IN_PLACE = "in_place"
    """Remove the horizontal path."""
    LOOP = "loop"
    """Keep the best loop, with its end blended into its beginning."""


@dataclass(frozen=True, slots=True)
class EditStep:
    """One step.

    start, end: seconds of the motion before this step, of a cut (by default its start and its end);
    fps: frames per second; min_seconds, max_seconds: bounds of a loop.
    """

    kind: EditKind
    start: float | None = None
    end: float | None = None
    fps: float | None = None
    min_seconds: float | None = None
    max_seconds: float | None = None

    def given(self) -> dict[str, Any]:
        """The members that have a value, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


_MEMBERS: Mapping[EditKind, tuple[str, ...]] = {
    EditKind.CUT: ("start", "end"),
    EditKind.MIRROR: (),
    EditKind.RESAMPLE: ("fps",),
    EditKind.IN_PLACE: (),
    EditKind.LOOP: ("min_seconds", "max_seconds"),
}
"""The members that each kind of step may have."""


@dataclass(frozen=True, slots=True)
class Result:
    """A motion after steps.

    done: the steps as they were done, with the times of cuts and loops; begins, ends: seconds of
    the original between which the result lies; is_mirrored: whether left and right are exchanged.
    """

    edited: Edited
    done: tuple[dict[str, Any], ...]
    begins: float
    ends: float
    is_mirrored: bool


def checked_steps(steps: Sequence[EditStep]) -> tuple[EditStep, ...]:
    """The steps. Raises BadField for none, too many, or members that do not go with their kind."""
    if not 1 <= len(steps) <= MAX_STEPS:
        raise bad_field("steps", f"must be 1 to {MAX_STEPS}")
    for index, step in enumerate(steps):
        given = step.given()
        for name in given.keys() - {"kind", *_MEMBERS[step.kind]}:
            raise bad_field(f"steps.{index}.{name}", f"goes not with {step.kind}")
        for name in given.keys() - {"kind"}:
            if not (math.isfinite(given[name]) and given[name] >= 0):
                raise bad_field(f"steps.{index}.{name}", "must be a number, zero or more")
        if step.kind is EditKind.RESAMPLE and not MIN_FPS <= (step.fps or 0.0) <= MAX_FPS:
            raise bad_field(f"steps.{index}.fps", f"must be from {MIN_FPS:g} to {MAX_FPS:g}")
    return tuple(steps)


def apply(edited: Edited, steps: Sequence[EditStep], max_frames: int) -> Result:
    """The motion after all steps, which `checked_steps` has checked.

    max_frames: the most frames of a resampled motion. Raises BadField for a step that cannot be
    done, TooShort for a loop of a motion that is too short.
    """
    result = Result(edited, (), 0.0, edited.frames / edited.rate, is_mirrored=False)
    for index, step in enumerate(steps):
        check()
        if step.kind is EditKind.RESAMPLE:
            _check_size(result.edited, step, f"steps.{index}.fps", max_frames)
        result = _STEPS[step.kind](result, step, f"steps.{index}")
    return result


def _cut(result: Result, step: EditStep, place: str) -> Result:
    edited = result.edited
    seconds = edited.frames / edited.rate
    start, end = step.start or 0.0, seconds if step.end is None else min(step.end, seconds)
    first, stop = round(start * edited.rate), round(end * edited.rate)
    if end - start < MIN_PART or first >= stop:
        raise bad_field(f"{place}.end", f"must be at least {MIN_PART:.2f} s after start={start:g}")
    kept = part(edited, first, stop)
    return _kept(result, kept, step, first / edited.rate, stop / edited.rate)


def _loop(result: Result, step: EditStep, place: str) -> Result:
    least = MIN_SECONDS if step.min_seconds is None else max(step.min_seconds, MIN_PART)
    if step.max_seconds is not None and step.max_seconds < least:
        raise bad_field(f"{place}.max_seconds", f"must be at least {least:g}")
    track = result.edited.track()
    found = best_loop(track, least, step.max_seconds)
    kept = loop(result.edited, found, track)
    changed = _kept(result, kept, step, found.start, found.end)
    done = {**changed.done[-1], "distance": round(found.distance, 4)}
    return replace(changed, done=(*result.done, done))


def _kept(result: Result, edited: Edited, step: EditStep, start: float, end: float) -> Result:
    """The result of a step that keeps a part, from `start` to `end` seconds."""
    done = {**step.given(), "start": round(start, 6), "end": round(end, 6)}
    return replace(
        result,
        edited=edited,
        done=(*result.done, done),
        begins=result.begins + start,
        ends=result.begins + end,
    )


def _mirror(result: Result, step: EditStep, _place: str) -> Result:
    return replace(
        result,
        edited=mirror(result.edited),
        done=(*result.done, step.given()),
        is_mirrored=not result.is_mirrored,
    )


def _resample(result: Result, step: EditStep, _place: str) -> Result:
    edited = result.edited
    animation = edited.animation.resampled(step.fps or edited.rate)
    done = (*result.done, step.given())
    return replace(result, edited=edited.with_animation(animation), done=done)


def _check_size(edited: Edited, step: EditStep, place: str, max_frames: int) -> None:
    seconds, joints = edited.frames / edited.rate, len(edited.animation.skeleton)
    fps = step.fps or edited.rate
    if fps * seconds > max(max_frames, edited.frames):
        raise bad_field(place, f"would make more than {max_frames} frames")
    if max(fps, edited.rate) * seconds * joints > MAX_POSITIONS:
        raise bad_field(place, f"would make more than {MAX_POSITIONS:,} frames times joints")


def _in_place(result: Result, step: EditStep, _place: str) -> Result:
    done = (*result.done, step.given())
    return replace(result, edited=in_place(result.edited), done=done)


_STEPS: Mapping[EditKind, Callable[[Result, EditStep, str], Result]] = {
    EditKind.CUT: _cut,
    EditKind.MIRROR: _mirror,
    EditKind.RESAMPLE: _resample,
    EditKind.IN_PLACE: _in_place,
    EditKind.LOOP: _loop,
}
