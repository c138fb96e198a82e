"""A ready clip reduced to few dimensions, by a model of its own poses or of other clips' poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.low_dimensional.eigen_motion import (
    PAPER_DIMENSIONS,
    Basis,
    EigenModel,
    eigen_model,
    low_dimensional,
    reconstruction_errors,
    uniform_frames,
)
from app.analysis.low_dimensional.plausibility import Plausibility, judge_poses
from app.deadline import check
from app.errors import NotEnoughKeyposes
from app.kinedex_error import Place
from app.motion.frame.body_frame import ANALYSIS_RATE, BodyTrack, body_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES, JointRole
from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray, IntArray
from app.services import fields
from app.services.library.keypose_frames import keypose_frames
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip, ready_clips
from app.services.library.stored_motion import load_motion
from app.services.views.frame_rates import requested_rate
from app.services.views.views import MotionView
from app.store.clips.record import ClipRecord

MIN_POSES = 2
"""Poses that a model needs: one pose spans no dimension."""
MAX_MODEL_CLIPS = 50
MAX_POSES = 1000
"""Largest number of uniform poses of one clip."""

Keyposes = dict[str, list[int]]
"""Frames at 30 Hz by clip id."""


@dataclass(frozen=True, slots=True)
class Reduction:
    """How to reduce a motion to few dimensions.

    dimensions: K', from 1 to the number of the model's poses (default: 3, or that number if it is
    smaller); model_clips: ids of the clips whose poses make the model (default: the clip
    itself); poses: number of poses of each clip, only with the uniform basis (default: its
    number of keyposes); keyposes: frames at 30 Hz by clip id, instead of model_clips.
    """

    dimensions: int | None = None
    basis: Basis | str = Basis.KEYPOSE
    model_clips: Sequence[str] = ()
    poses: int | None = None
    keyposes: Mapping[str, Sequence[int]] | None = None


@dataclass(frozen=True, slots=True)
class ModelPose:
    """A pose of the model: its clip and its time in seconds."""

    clip_id: str
    time: float


@dataclass(frozen=True, slots=True)
class Reduced:
    """A motion and its reduction to few dimensions.

    model: made of K `poses`; eigen_poses: (K, 3) their coordinates along the first axes (figs 7,
    8); original, reduced: the motion before and after, at 30 Hz; eigen_motion: (n, 3) its curve
    (fig. 9); variance_kept, errors: (K,) for K' = 1..K, errors in meters.
    """

    basis: Basis
    dimensions: int
    model: EigenModel
    poses: tuple[ModelPose, ...]
    eigen_poses: FloatArray
    original: BodyTrack
    reduced: BodyTrack
    eigen_motion: FloatArray
    variance_kept: FloatArray
    errors: FloatArray


@dataclass(frozen=True, slots=True)
class ReducedView:
    """A reduced motion to show: motion and eigen_motion at the requested frame rate; faults of
    the motion and of the original, in frames at 30 Hz."""

    reduced: Reduced
    motion: MotionView
    eigen_motion: FloatArray
    plausibility: Plausibility
    original_plausibility: Plausibility


def view(lib: Library, clip_id: str, reduction: Reduction, fps: float | None = None) -> ReducedView:
    """A clip reduced to few dimensions, resampled by time to `fps` (default 30 Hz).

    Raises BadField, ClipNotFound, ClipNotReady, NotEnoughKeyposes.
    """
    clip = ready_clip(lib, clip_id)
    rate = frame_rate(lib, clip, fps)
    result = reduce(lib, clip, reduction)
    track = result.reduced
    names = tuple(role.value for role in SUN_ROLES)
    positions = resample(track.positions, track.rate, rate)
    return ReducedView(
        result,
        MotionView(rate, names, SUN_PARENTS, positions.astype(np.float32)),
        resample(result.eigen_motion, track.rate, rate),
        judge_poses(track.local),
        judge_poses(result.original.local),
    )


def reduce(lib: Library, clip: ClipRecord, reduction: Reduction) -> Reduced:
    """A ready clip's motion reduced to few dimensions (Perera 2009).

    Raises BadField, ClipNotFound, ClipNotReady, NotEnoughKeyposes.
    """
    basis = _checked_basis(reduction)
    track = body_track(load_motion(lib, clip))
    poses, local = _model_poses(lib, clip, track, reduction, basis)
    model = eigen_model(local)
    dimensions = reduction.dimensions or min(PAPER_DIMENSIONS, model.poses)
    if dimensions > model.poses:
        message = f"must be from 1 to {model.poses}, the poses of the model"
        raise fields.bad_field("dimensions", message)
    return Reduced(
        basis=basis,
        dimensions=dimensions,
        model=model,
        poses=poses,
        eigen_poses=_shown(model, local),
        original=track,
        reduced=low_dimensional(model, track, dimensions),
        eigen_motion=_shown(model, track.local),
        variance_kept=model.variance_kept(),
        errors=reconstruction_errors(model, track),
    )


def keyposes_of(lib: Library, clip: ClipRecord, model_clips: Sequence[str] = ()) -> Keyposes:
    """The frames (at 30 Hz, by clip id) of the model of `model_clips`, or of `clip` itself.

    Raises BadField, ClipNotFound, ClipNotReady.
    """
    _check_clips(model_clips)
    frames: Keyposes = {}
    clips = ready_clips(lib, model_clips, "model_clips") or {clip.id: clip}
    for clip_id, model_clip in clips.items():
        check()  # many clips take long: stop after the deadline of the request
        track = body_track(load_motion(lib, model_clip))
        frames[clip_id] = keypose_frames(lib, clip_id, track).tolist()
    return frames


def frame_rate(lib: Library, clip: ClipRecord, fps: float | None) -> float:
    """`fps`, or 30 Hz if it is None. Raises BadField for a rate that is not possible."""
    return requested_rate(lib, clip, fps, source=ANALYSIS_RATE, joints=len(SUN_ROLES))


def as_motion(result: Reduced, clip: ClipRecord) -> Motion:
    """The reduced motion for files, at 30 Hz, in meters and in the size of the clip.

    Its skeleton has the 13 joint roles, each after its parent, as file formats need it.
    """
    order = _parents_first()
    new_index = {joint: index for index, joint in enumerate(order)}
    missing = tuple(JointRole(role) for role in clip.missing_roles)
    roles = [SUN_ROLES[joint] for joint in order]
    return Motion(
        format=clip.format or "",
        names=tuple(role.value for role in roles),
        parents=np.array([new_index.get(SUN_PARENTS[joint], -1) for joint in order]),
        positions=result.reduced.positions[:, order].astype(np.float32),
        roles={role: index for index, role in enumerate(roles) if role not in missing},
        missing_roles=missing,
        frame_rate=result.reduced.rate,
        declared_frame_rate=None,
        metres_per_unit=1.0,
    )


def _parents_first() -> list[int]:
    """The indexes of the 13 joint roles, sorted so that each parent is before its children."""
    order = [joint for joint, parent in enumerate(SUN_PARENTS) if parent < 0]
    for joint in order:  # `order` grows in the loop, which visits the new joints too
        order += [child for child, parent in enumerate(SUN_PARENTS) if parent == joint]
    return order


def _model_poses(
    lib: Library, clip: ClipRecord, track: BodyTrack, reduction: Reduction, basis: Basis
) -> tuple[tuple[ModelPose, ...], FloatArray]:
    """The K poses of the model, and their positions (K, 13, 3) in the body frame, body lengths."""
    poses: list[ModelPose] = []
    local: list[FloatArray] = []
    keypose_counts: dict[str, int] = {}
    model_ids = tuple(reduction.keyposes or reduction.model_clips)
    clips = ready_clips(lib, model_ids, "model_clips") or {clip.id: clip}
    for clip_id, model_clip in clips.items():
        check()  # many clips take long: stop after the deadline of the request
        own_track = track
        if clip_id != clip.id:
            own_track = body_track(load_motion(lib, model_clip))
        if reduction.keyposes is None:
            frames = keypose_frames(lib, clip_id, own_track)
        else:
            frames = _frames_within(reduction.keyposes[clip_id], own_track)
        keypose_counts[clip_id] = len(frames)
        # The uniform basis has as many poses as the keypose basis, so that both can be compared.
        count = reduction.poses or len(frames)
        if basis is Basis.UNIFORM and count:
            frames = uniform_frames(own_track.frames, min(count, own_track.frames))
        poses += [ModelPose(clip_id, float(frame / own_track.rate)) for frame in frames]
        local.append(own_track.local[frames])
    if len(poses) < MIN_POSES:
        raise _too_few(keypose_counts, len(poses))
    return tuple(poses), np.concatenate(local)


def _frames_within(frames: Sequence[int], track: BodyTrack) -> IntArray:
    """The stored frames that the clip still has; a new analysis may have made it shorter."""
    return np.array([frame for frame in frames if 0 <= frame < track.frames], dtype=np.int64)


def _too_few(keypose_counts: dict[str, int], poses: int) -> NotEnoughKeyposes:
    return NotEnoughKeyposes(
        f"A model needs at least {MIN_POSES} poses; found {poses}. Use other model_clips, "
        "or basis=uniform with a number of poses, or annotate the keyposes.",
        places=[
            Place("model_clips", f"{clip_id}: keyposes: {count}")
            for clip_id, count in keypose_counts.items()
        ],
    )


def _checked_basis(reduction: Reduction) -> Basis:
    """The basis of a valid reduction. Raises BadField for an invalid reduction."""
    try:
        basis = Basis(reduction.basis)
    except ValueError:
        raise fields.bad_field("basis", f"must be one of {', '.join(Basis)}") from None
    if reduction.dimensions is not None and reduction.dimensions < 1:
        raise fields.bad_field("dimensions", "must be at least 1")
    _check_clips(reduction.model_clips)
    if reduction.poses is not None and basis is not Basis.UNIFORM:
        raise fields.bad_field("poses", "needs basis=uniform; the number of keyposes is fixed")
    if reduction.poses is not None and not 1 <= reduction.poses <= MAX_POSES:
        raise fields.bad_field("poses", f"must be from 1 to {MAX_POSES}")
    return basis


def _check_clips(model_clips: Sequence[str]) -> None:
    if len(model_clips) > MAX_MODEL_CLIPS:
        raise fields.bad_field("model_clips", f"must be at most {MAX_MODEL_CLIPS} clips")


def _shown(model: EigenModel, poses: FloatArray) -> FloatArray:
    """(n, 3) coordinates along the first three axes; 0 for axes that the model does not have."""
    coordinates = np.zeros((len(poses), PAPER_DIMENSIONS))
    count = min(PAPER_DIMENSIONS, model.poses)
    coordinates[:, :count] = model.coordinates(poses, count)
    return coordinates
