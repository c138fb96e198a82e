"""Motion volumes of a library's clips: figures 6 and 7 and section 5.3 of Sun 2011."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_volume import compression_ratio, self_similarity
from app.evaluate.retrieval.evaluation import HIDDEN_CLASSES
from app.evaluate.retrieval.labeled import LabeledClips, read_labeled
from app.evaluate.retrieval.rankings import Volumes
from app.motion.frame.body_frame import smooth_track
from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1
from app.search.example.distances import EPSILON, RHO
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.store.clips import arrays
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

MAX_PER_CLASS = 40
"""Largest number of clips of a class whose vectors are drawn; more would hide each other."""
CLIPS_PER_LOAD = 256
"""Number of clips whose arrays are loaded at a time."""


@dataclass(frozen=True, slots=True)
class Compression:
    """Compression ratio of the factors of `clips` clips with `frames` frames in total, 13 joints.

    formula: by section 5.3; measured: bytes of rho and epsilon divided by bytes of the joint
    positions in the store.
    """

    clips: int
    frames: int
    formula: float
    measured: float


@dataclass(frozen=True, slots=True)
class VolumeEvaluation:
    """Rank-1 factors of clips by class, and their compression ratio.

    q, threshold: of the self-similarity matrices; factors: of at most MAX_PER_CLASS clips of
    each class; examples: (n, 13, 13) the matrices of one clip of each class, at ANALYSIS_RATE.
    """

    q: int
    threshold: float
    factors: dict[str, tuple[Rank1, ...]]
    compression: Compression
    examples: dict[str, FloatArray] = field(default_factory=dict)

    @property
    def iterations(self) -> tuple[int, ...]:
        """The number of iterations of each clip."""
        return tuple(one.iterations for some in self.factors.values() for one in some)

    @property
    def converged(self) -> int:
        """The number of clips whose iteration converged."""
        return sum(one.converged for some in self.factors.values() for one in some)


def judge_volumes(
    lib: Library,
    filter: ClipFilter | None = None,
    *,
    classes: Sequence[str] | None = None,
    q: int = 2,
    threshold: float = 0.0,
    step: Callable[[], None] = lambda: None,
) -> VolumeEvaluation:
    """Judge the given classes, or the largest four. Raises NotEnoughLabels, BadField."""
    labeled = read_labeled(lib, filter)
    sampled = {
        name: _sample(labeled, name, MAX_PER_CLASS)
        for name in labeled.chosen(classes, HIDDEN_CLASSES)
    }
    return VolumeEvaluation(
        q=q,
        threshold=threshold,
        factors={
            name: tuple(
                Volumes.of(lib, members, q=q, threshold=threshold, step=step).factors.values()
            )
            for name, members in sampled.items()
        },
        compression=_compression(lib, labeled.clips),
        examples={
            name: _matrices(lib, members[0], q=q, threshold=threshold)
            for name, members in sampled.items()
        },
    )


def _matrices(lib: Library, clip: ClipRecord, *, q: int, threshold: float) -> FloatArray:
    """(n, 13, 13) self-similarity matrices of the active part of a clip."""
    track = active_part(smooth_track(load_motion(lib, clip)))
    return self_similarity(track.local, q=q, threshold=threshold)


def _sample(labeled: LabeledClips, name: str, max_count: int) -> list[ClipRecord]:
    """Clips of a class; if there are too many, an even selection by id."""
    members = [clip for clip in labeled.clips if clip.task == name]
    indices = np.unique(np.linspace(0, len(members) - 1, min(max_count, len(members))).round())
    return [members[int(index)] for index in indices]


def _compression(lib: Library, measured: Sequence[ClipRecord]) -> Compression:
    frames, factor_bytes, position_bytes = [], 0, 0
    for start in range(0, len(measured), CLIPS_PER_LOAD):
        ids = [clip.id for clip in measured[start : start + CLIPS_PER_LOAD]]
        with lib.store.read() as tx:
            rhos, epsilons, joints = (
                arrays.get_many(tx, ids, name) for name in (RHO, EPSILON, "role_positions")
            )
        frames += [len(epsilon) for epsilon in epsilons.values()]
        factor_bytes += sum(array.nbytes for part in (rhos, epsilons) for array in part.values())
        # volumes are of the active parts, and are compared with the positions in these
        position_bytes += sum(joints[one][: len(part)].nbytes for one, part in epsilons.items())
    return Compression(
        len(frames), sum(frames), compression_ratio(frames), factor_bytes / position_bytes
    )
