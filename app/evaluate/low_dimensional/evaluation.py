"""Compares keyposes with uniform poses as basis of low-dimensional motion (Perera 2009, section 4).

The figures are the variance kept, the error, the clustering of the poses, and implausible poses.
Each clip with enough keyposes is reduced with its own poses. Clips of several persons at one task,
one for each person, are also reduced with the poses of all of them (section 4.2).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
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
from app.analysis.low_dimensional.plausibility import Fault, Implausible, Plausibility, judge_poses
from app.errors import NotEnoughKeyposes
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.clusteredness import best_clusters, clusteredness
from app.services.library.keypose_frames import keypose_frames
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.training.training_set import ready_only
from app.store.clips import listing as clip_listing
from app.store.clips import repository as stored
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

MAX_DIMENSIONS = 10
"""Number of rows of the table."""
MIN_KEYPOSES = PAPER_DIMENSIONS + 1
"""Keyposes that a judged clip needs: fewer span less than the three dimensions of the paper."""
ORIGINAL = "original"

Progress = Callable[[int, int], None]
"""Called after each clip with the number of clips done and the total."""


@dataclass(frozen=True, slots=True)
class DimensionRow:
    """Means for one number of dimensions, over the clips whose models have enough poses.

    variance: share that each basis keeps of its own poses (eq. 9); error: of the whole motion in
    mm, by basis; best: the smallest possible error in mm, by the axes of all frames;
    keypose_better: share of the clips with a smaller error by keyposes.
    """

    dimensions: int
    clips: int
    variance: Mapping[str, float]
    error: Mapping[str, float]
    best: float
    keypose_better: float


@dataclass(frozen=True, slots=True)
class PoseRow:
    """Figures of a basis at three dimensions, or of the original motion.

    frames: their number; implausible: the number of frames with an impossible pose, in total and
    by fault; silhouette: mean over the clips of the silhouette of the model's poses, None for
    the original.
    """

    name: str
    frames: int
    implausible: int
    faults: Mapping[str, int]
    silhouette: float | None


@dataclass(frozen=True, slots=True)
class GroupRow:
    """Several persons at one task with a common model, at three dimensions.

    poses: K; by basis: variance kept, error (mm) over all their clips, silhouette of the poses,
    and its excess over that of poses without clusters (None if the poses do not differ).
    """

    task: str
    persons: int
    poses: int
    variance: Mapping[str, float]
    error: Mapping[str, float]
    silhouette: Mapping[str, float | None]
    gap: Mapping[str, float | None]


@dataclass(frozen=True, slots=True)
class JudgedClip:
    """One clip and the models of its own poses; keyposes: frames of `track`."""

    clip: ClipRecord
    track: BodyTrack
    keyposes: IntArray
    models: Mapping[Basis, EigenModel]

    def poses(self, basis: Basis) -> FloatArray:
        """(K, 13, 3) the poses of a basis, in body lengths."""
        frames = self.keyposes
        if basis is Basis.UNIFORM:
            frames = uniform_frames(self.track.frames, len(frames))
        return np.asarray(self.track.local[frames])


@dataclass(frozen=True, slots=True)
class WorstPose:
    """The longest fault of a reduced motion at a time without a fault in the original (figs 13,
    14), with its worst moment, in frames of the clip's track."""

    judged: JudgedClip
    basis: Basis
    fault: Implausible


@dataclass(frozen=True, slots=True)
class LowDimensionalEvaluation:
    """The results of `kinedex evaluate low-dimensional`.

    clips: number of judged clips; left_out: number of ready clips with fewer than MIN_KEYPOSES
    keyposes; more_clustered: share of clips whose keyposes cluster better than their uniform
    poses; shown: the clip with most keyposes, for the pictures; shown_group: the clips of the
    largest group; worst: an implausible pose, None if there is none.
    """

    clips: int
    left_out: int
    dimensions: tuple[DimensionRow, ...]
    poses: tuple[PoseRow, ...]
    more_clustered: float
    groups: tuple[GroupRow, ...]
    shown: JudgedClip
    shown_group: tuple[JudgedClip, ...]
    worst: WorstPose | None


def judge_low_dimensional(
    lib: Library, filter: ClipFilter | None = None, progress: Progress | None = None
) -> LowDimensionalEvaluation:
    """Judge both bases on the clips that pass the filter.

    Raises NotEnoughKeyposes if no clip has enough keyposes.
    """
    with lib.store.read() as tx:
        ids = sorted(clip_listing.list_ids(tx, ready_only(filter)))
        ready = list(stored.get_many(tx, ids).values())
    judged = list(_judged(lib, ready, progress))
    if not judged:
        raise NotEnoughKeyposes(
            f"No ready clip has {MIN_KEYPOSES} keyposes; {len(ready)} were looked at."
        )
    groups = _groups(judged)
    silhouettes = {basis: [_silhouette(one, basis) for one in judged] for basis in Basis}
    pairs = list(zip(silhouettes[Basis.KEYPOSE], silhouettes[Basis.UNIFORM], strict=True))
    originals = [judge_poses(one.track.local) for one in judged]
    reductions = {basis: [_judged_reduction(one, basis) for one in judged] for basis in Basis}
    return LowDimensionalEvaluation(
        clips=len(judged),
        left_out=len(ready) - len(judged),
        dimensions=tuple(_dimension_rows(judged)),
        poses=(
            _pose_row(ORIGINAL, originals, None),
            *(_pose_row(b.value, reductions[b], float(np.mean(silhouettes[b]))) for b in Basis),
        ),
        more_clustered=float(np.mean([keyposes > uniform for keyposes, uniform in pairs])),
        groups=tuple(_group_row(task, clips) for task, clips in groups.items()),
        shown=max(judged, key=lambda one: len(one.keyposes)),
        shown_group=max(groups.values(), key=len, default=()),
        worst=_worst(judged, originals, reductions),
    )


def _judged(
    lib: Library, ready: Sequence[ClipRecord], progress: Progress | None
) -> Iterator[JudgedClip]:
    """The clips with enough keyposes."""
    for done, clip in enumerate(ready, 1):
        track = body_track(load_motion(lib, clip))
        frames = keypose_frames(lib, clip.id, track)
        if len(frames) >= MIN_KEYPOSES:
            uniform = uniform_frames(track.frames, len(frames))
            models = {
                Basis.KEYPOSE: eigen_model(track.local[frames]),
                Basis.UNIFORM: eigen_model(track.local[uniform]),
            }
            yield JudgedClip(clip, track, frames, models)
        if progress is not None:
            progress(done, len(ready))


def _dimension_rows(judged: Sequence[JudgedClip]) -> Iterator[DimensionRow]:
    """The rows of the table. A clip counts only in rows up to its number of poses."""
    variances = {b: [one.models[b].variance_kept() for one in judged] for b in Basis}
    errors = {
        b: [1000 * reconstruction_errors(one.models[b], one.track) for one in judged] for b in Basis
    }
    best = [1000 * reconstruction_errors(eigen_model(o.track.local), o.track) for o in judged]
    for row in range(MAX_DIMENSIONS):
        with_row = [i for i, one in enumerate(judged) if len(one.keyposes) > row]
        if not with_row:
            return
        by_keyposes, by_uniform = (np.array([errors[b][i][row] for i in with_row]) for b in Basis)
        yield DimensionRow(
            dimensions=row + 1,
            clips=len(with_row),
            variance={
                b.value: float(np.mean([variances[b][i][row] for i in with_row])) for b in Basis
            },
            error={
                Basis.KEYPOSE.value: float(by_keyposes.mean()),
                Basis.UNIFORM.value: float(by_uniform.mean()),
            },
            best=float(np.mean([best[i][row] for i in with_row])),
            keypose_better=float(np.mean(by_keyposes < by_uniform)),
        )


def _judged_reduction(one: JudgedClip, basis: Basis) -> Plausibility:
    return judge_poses(low_dimensional(one.models[basis], one.track, PAPER_DIMENSIONS).local)


def _pose_row(name: str, found: Sequence[Plausibility], silhouette: float | None) -> PoseRow:
    faults: Counter[Fault] = Counter()
    for plausibility in found:
        for fault in plausibility.faults:
            faults[fault.fault] += fault.last - fault.first + 1
    return PoseRow(
        name=name,
        frames=sum(len(plausibility.implausible) for plausibility in found),
        implausible=sum(plausibility.count for plausibility in found),
        faults={fault.value: faults[fault] for fault in Fault},
        silhouette=silhouette,
    )


def _worst(
    judged: Sequence[JudgedClip],
    originals: Sequence[Plausibility],
    reductions: Mapping[Basis, Sequence[Plausibility]],
) -> WorstPose | None:
    found = [
        WorstPose(one, basis, fault)
        for basis, plausibilities in reductions.items()
        for one, original, plausibility in zip(judged, originals, plausibilities, strict=True)
        for fault in plausibility.faults
        if not original.implausible[fault.worst]
    ]
    return max(found, key=lambda one: one.fault.last - one.fault.first, default=None)


def _silhouette(one: JudgedClip, basis: Basis) -> float:
    """The silhouette of the poses; 0 if they do not differ."""
    found = best_clusters(one.models[basis].coordinates(one.poses(basis), PAPER_DIMENSIONS))
    return 0.0 if found is None else found.silhouette


def _groups(judged: Sequence[JudgedClip]) -> dict[str, tuple[JudgedClip, ...]]:
    """For each task of several persons, one clip of each: the one with most keyposes."""
    by_task: dict[str, dict[str, JudgedClip]] = {}
    for one in sorted(judged, key=lambda one: (-len(one.keyposes), one.clip.id)):
        if one.clip.task and one.clip.person:
            by_task.setdefault(one.clip.task, {}).setdefault(one.clip.person, one)
    return {
        task: tuple(by_task[task].values()) for task in sorted(by_task) if len(by_task[task]) > 1
    }


def _group_row(task: str, clips: Sequence[JudgedClip]) -> GroupRow:
    poses = {b: np.concatenate([one.poses(b) for one in clips]) for b in Basis}
    models = {b: eigen_model(poses[b]) for b in Basis}
    shown = {b: clusteredness(models[b].coordinates(poses[b], PAPER_DIMENSIONS)) for b in Basis}
    return GroupRow(
        task=task,
        persons=len(clips),
        poses=models[Basis.KEYPOSE].poses,
        variance={b.value: float(models[b].variance_kept()[PAPER_DIMENSIONS - 1]) for b in Basis},
        error={b.value: 1000 * _joint_error(models[b], clips) for b in Basis},
        silhouette={b.value: c.clusters.silhouette if c else None for b, c in shown.items()},
        gap={b.value: c.gap if c else None for b, c in shown.items()},
    )


def _joint_error(model: EigenModel, clips: Sequence[JudgedClip]) -> float:
    """The error in meters over all frames of all clips."""
    squares = [
        one.track.frames * reconstruction_errors(model, one.track)[PAPER_DIMENSIONS - 1] ** 2
        for one in clips
    ]
    return float(np.sqrt(sum(squares) / sum(one.track.frames for one in clips)))
