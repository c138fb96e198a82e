"""Functions that rank the library for a clip.

They use the search methods, or Sun's methods with other settings.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_volume import cross_correlations, decompose, warping_distances
from app.motion.frame.body_frame import smooth_track
from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1
from app.search.example.by_example import COMPARED, rank_by_example
from app.search.example.distances import EPSILON, RHO, Descriptors
from app.search.example.methods import Method
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.store.clips import arrays
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

RHO_ALONE, NORMALIZED = "rho alone", "msv-xcorr normalized"

Ranker = Callable[[ClipRecord], Sequence[str]]
"""Returns the ids of all clips that pass the filter for a query clip, the nearest first. The query
itself may be among them."""


def by_method(lib: Library, method: Method, filter: ClipFilter | None) -> Ranker:
    """A function that ranks as searches do, by `method` among the clips that pass the filter."""
    load = partial(lib.arrays.get_many, lib.store)

    def rank(clip: ClipRecord) -> Sequence[str]:
        query, itself = _query(lib, clip), frozenset({clip.id})
        passing = filter or ClipFilter()
        found = rank_by_example(lib.index, query, method, passing, itself, load, paced=lib.paced)
        return list(found.ids)

    return rank


def _query(lib: Library, clip: ClipRecord) -> Descriptors:
    with lib.store.read() as tx:
        return arrays.get_named(tx, clip.id, COMPARED)


@dataclass(frozen=True, slots=True)
class Volumes:
    """Rank-1 factors of clips' motion volumes with one q and threshold, by clip id."""

    factors: dict[str, Rank1]

    @classmethod
    def of(
        cls,
        lib: Library,
        chosen: Sequence[ClipRecord],
        *,
        q: int,
        threshold: float,
        step: Callable[[], None] = lambda: None,
    ) -> Volumes:
        """Compute the factors from the stored motions; `step` is called after each clip."""
        factors = {}
        for clip in chosen:
            track = active_part(smooth_track(load_motion(lib, clip)))
            factors[clip.id] = decompose(track, q=q, threshold=threshold)
            step()
        return cls(factors)

    def by(self, method: Method) -> Ranker:
        """A ranker by D_dtw (eq. 7, smallest first) or by D_xcorr (eq. 6, largest first)."""
        compare: _Compare = {
            Method.MSV_DTW: warping_distances,
            Method.MSV_XCORR: lambda *volumes: -cross_correlations(*volumes),
        }[method]
        rhos = {clip_id: one.primary for clip_id, one in self.factors.items()}
        epsilons = {clip_id: one.secondary for clip_id, one in self.factors.items()}
        return _by_factors(rhos, epsilons, compare)


def by_stored_factors(lib: Library, chosen: Sequence[ClipRecord]) -> dict[str, Ranker]:
    """Rankers by the stored factors (q = 2, no threshold) that are no method of the paper.

    RHO_ALONE: the Euclidean distance of the primary vectors, a baseline: what epsilon adds.
    NORMALIZED: D_xcorr without the ratio of the lengths, see `cross_correlations`.
    """
    ids = [clip.id for clip in chosen]
    with lib.store.read() as tx:
        rhos, epsilons = (arrays.get_many(tx, ids, name) for name in (RHO, EPSILON))
    return {
        RHO_ALONE: _by_factors(rhos, epsilons, _apart),
        NORMALIZED: _by_factors(
            rhos, epsilons, lambda *volumes: -cross_correlations(*volumes, normalized=True)
        ),
    }


_Compare = Callable[[FloatArray, FloatArray, FloatArray, Sequence[FloatArray]], FloatArray]


def _by_factors(
    rhos: Mapping[str, FloatArray], epsilons: Mapping[str, FloatArray], compare: _Compare
) -> Ranker:
    ids = list(rhos)
    stacked, others = np.stack([rhos[one] for one in ids]), [epsilons[one] for one in ids]

    def rank(clip: ClipRecord) -> Sequence[str]:
        distances = compare(rhos[clip.id], epsilons[clip.id], stacked, others)
        return [ids[i] for i in np.argsort(distances, kind="stable") if ids[i] != clip.id]

    return rank


def _apart(rho: FloatArray, _epsilon: object, rhos: FloatArray, _epsilons: object) -> FloatArray:
    return np.asarray(np.linalg.norm(rhos.astype(np.float64) - rho, axis=1))
