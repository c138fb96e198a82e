"""The parts of a synthesized motion that come from real clips: a skeleton with its habits, and the
fast detail of a take."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_shape import moments_of
from app.errors import ClipNotFound, ClipNotReady, NotEnoughLabels
from app.models.synthesis.body import Donor, same_body
from app.models.synthesis.model import Synthesis
from app.motion.frame.body_frame import ANALYSIS_RATE, body_track, smooth_track
from app.motion.frame.posed_start import posed_frames
from app.motion.motion import Motion
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import Animation
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.synthesis.plan import Plan
from app.services.training.synthesis_fit import SHAPE
from app.services.views.clip_rotations import own_animation
from app.store.clips.record import ClipRecord

MAX_DONORS = 5
"""Largest number of clips of the person that give poses: those most like the predicted shape."""


@dataclass(frozen=True, slots=True)
class Material:
    """The real material of a synthesis.

    donors: clips with the same skeleton; body_length: meters; take: (n, 43) moments of a real
    take and take_shape: (1378,) its shape, None for a cyclic motion; license, words: those that
    all sources and takes share; roles: joint names by role, if a client gave them.
    """

    donors: list[Donor]
    body_length: float
    take: FloatArray | None
    take_shape: FloatArray | None
    license: str | None
    words: tuple[str, ...]
    roles: dict[str, str] | None


def material_of(lib: Library, model: Synthesis, plan: Plan) -> Material:
    """The material for a plan. Raises NotEnoughLabels if its clips were removed."""
    distances = dict(zip(model.ids, model.distances(plan.shape), strict=True))
    own = _still_ready(lib, sorted(plan.own, key=lambda clip: distances.get(clip, np.inf)))
    takes = _still_ready(lib, sorted(plan.takes, key=lambda clip: distances.get(clip, np.inf)))
    if not own or not takes:
        raise NotEnoughLabels("The source clips of this motion were removed: fit the models again.")
    donors = same_body([_donor(lib, clip) for clip in own[:MAX_DONORS]])
    take, take_shape = None, None
    if plan.shape[-1] < 0.5:  # the last number of a shape says whether the motion is cyclic
        take, take_shape = _detail(lib, takes)
    licenses = {clip.license for clip in (*own, *takes)}
    words = set.intersection(*(set(clip.words) for clip in takes))
    return Material(
        donors=donors,
        body_length=float(np.median([donor.track.body_length for donor in donors])),
        take=take,
        take_shape=take_shape,
        license=licenses.pop() if len(licenses) == 1 else None,
        words=tuple(sorted(words)),
        roles=_roles_of_joints(own[0]),
    )


def _roles_of_joints(clip: ClipRecord) -> dict[str, str] | None:
    """The client's roles; None if one is the middle of two joints, which only markers have."""
    roles = clip.hints.roles or {}
    joints = {role: joint for role, joint in roles.items() if isinstance(joint, str)}
    return joints if joints and len(joints) == len(roles) else None


def _still_ready(lib: Library, clip_ids: list[str]) -> list[ClipRecord]:
    ready = []
    for clip_id in clip_ids:
        try:
            ready.append(ready_clip(lib, clip_id))
        except (ClipNotFound, ClipNotReady):
            continue  # removed, or in a new analysis, since the fit of the models
    return ready


def _detail(lib: Library, takes: list[ClipRecord]) -> tuple[FloatArray | None, FloatArray | None]:
    """The first non-cyclic take as moments (n, 43) and as shape (1378,); None if all are cyclic.

    takes: sorted by their distance to the predicted shape.
    """
    with lib.store.read() as tx:
        shapes = usable_arrays.get_many(tx, [clip.id for clip in takes], SHAPE)
    for clip in takes:
        shape = shapes.get(clip.id)
        if shape is not None and shape[-1] < 0.5:
            return detail_of(load_motion(lib, clip)), shape.astype(np.float64)
    return None, None


def detail_of(motion: Motion) -> FloatArray:
    """(n, 43) moments of the active part of a take, from which its shape was computed too."""
    return moments_of(active_part(smooth_track(motion)))


def _donor(lib: Library, clip: ClipRecord) -> Donor:
    motion = load_motion(lib, clip)
    return donor_of(motion, own_animation(lib, clip, motion, motion.frame_rate))


def donor_of(motion: Motion, animation: Animation) -> Donor:
    """A donor from the motion of a clip and its animation, which have the same frames.

    A pose at the start that does not belong to the motion is left out.
    """
    joints = dict(motion.roles)
    if np.sum(animation.skeleton.parents < 0) != 1:
        # markers have no skeleton, so the canonical body is used
        animation = on_canonical_body(motion)
        joints = {JointRole(name): i for i, name in enumerate(animation.skeleton.names)}
    track, turning = body_track(motion), animation.resampled(ANALYSIS_RATE)
    first = int(np.ceil(posed_frames(motion) / motion.frame_rate * ANALYSIS_RATE))
    stop = min(len(turning.rotations), track.frames)
    cut = replace(
        turning,
        rotations=turning.rotations[first:stop],
        translations=turning.translations[first:stop],
    )
    return Donor(cut, track.part(first, stop), joints)
