"""A part of a clip, for exports."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app.motion.motion import Motion
from app.motion.skeleton.animation import Animation


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a clip, in seconds; end: None for its end."""

    start: float
    end: float | None

    def frames(self, rate: float, count: int) -> slice:
        """The frames of the part, at least one. rate: Hz; count: of the whole clip."""
        first = min(round(self.start * rate), count - 1)
        stop = count if self.end is None else min(round(self.end * rate), count)
        return slice(first, max(stop, first + 1))


def part_of_motion(motion: Motion, part: Part | None) -> Motion:
    """The motion within a part; all of it without one."""
    if part is None:
        return motion
    frames = part.frames(motion.frame_rate, motion.frames)
    return replace(motion, positions=motion.positions[frames])


def part_of_animation(animation: Animation, part: Part | None) -> Animation:
    """The animation within a part; all of it without one."""
    if part is None:
        return animation
    frames = part.frames(animation.frame_rate, len(animation.rotations))
    return replace(
        animation,
        rotations=animation.rotations[frames],
        translations=animation.translations[frames],
    )
