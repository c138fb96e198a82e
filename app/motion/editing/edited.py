"""A motion with its rotations, as edits change it: cut, at another rate, or in place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from app.motion.frame.body_frame import BodyTrack, body_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Edited:
    """An animation (meters, Y up), and the joint of each role that is known."""

    animation: Animation
    roles: Mapping[JointRole, int]

    @property
    def rate(self) -> float:
        """Frames per second."""
        return self.animation.frame_rate

    @property
    def frames(self) -> int:
        """The number of frames."""
        return len(self.animation.rotations)

    def with_animation(self, animation: Animation) -> Edited:
        """The same roles with another animation of the same joints."""
        return replace(self, animation=animation)

    def motion(self) -> Motion:
        """The positions of the joints as a canonical motion."""
        skeleton, rate = self.animation.skeleton, self.rate
        return Motion(
            format="bvh",
            names=skeleton.names,
            parents=skeleton.parents,
            positions=np.ascontiguousarray(self.animation.positions(), dtype=np.float32),
            roles=dict(self.roles),
            missing_roles=tuple(role for role in SUN_ROLES if role not in self.roles),
            frame_rate=rate,
            declared_frame_rate=rate,
            metres_per_unit=1.0,
        )

    def track(self) -> BodyTrack:
        """The track of the body at 30 Hz. Raises TooShort, NotHuman."""
        return body_track(self.motion())

    def headings(self, track: BodyTrack) -> FloatArray:
        """(frames,) the heading of each frame, radians, from the track of this motion."""
        times = np.arange(self.frames) / self.rate
        return np.interp(times, np.arange(track.frames) / track.rate, track.heading)


def part(edited: Edited, first: int, stop: int) -> Edited:
    """The frames first .. stop - 1."""
    animation = edited.animation
    return edited.with_animation(
        replace(
            animation,
            rotations=animation.rotations[first:stop],
            translations=animation.translations[first:stop],
        )
    )


def in_place(edited: Edited) -> Edited:
    """The motion without the horizontal path of the hips, which stay where they are first.

    Heights and turns stay.
    """
    animation = edited.animation
    roots = np.flatnonzero(animation.skeleton.parents < 0)
    path = animation.positions()[:, edited.roles[JointRole.HIPS]]
    path = (path - path[0]) * np.array([1.0, 0.0, 1.0])
    translations = np.array(animation.translations, dtype=np.float64)
    translations[:, roots] -= path[:, None]
    return edited.with_animation(replace(animation, translations=translations))
