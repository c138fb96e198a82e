"""Rank clips by their motion volumes with other options than those of the stored factors.

The factors of the query and of all clips that pass the filter are computed from the stored motions:
20 ms for each clip on an idle machine. Those of the last searches stay in memory.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_volume import (
    MAX_CROSS_CORRELATION,
    cross_correlations,
    decompose,
)
from app.motion.frame.body_frame import smooth_track
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.search.example.distances import EPSILON, RHO, Loader, distances_to
from app.search.example.methods import Method
from app.search.ranking.ranking import Ranking
from app.services import fields
from app.services.find.queries import MotionQuery
from app.services.find.query import describe, query_motion
from app.services.library.library import Library
from app.services.library.stored_motion import read_motion
from app.services.volume_options import MAX_CLIPS, VolumeOptions
from app.store.clips import repository as stored
from app.store.clips.filter import ClipFilter

JOINTS = 13


@dataclass(frozen=True, slots=True)
class VolumeRanking:
    """A ranking by motion volumes; digest: of the query's factors and of what is left out."""

    ranking: Ranking
    digest: str


def rank_by_volumes(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> VolumeRanking:
    """Rank all clips that pass the filter. The index must have caught up with the library.

    Raises BadField (also if too many clips pass the filter), ClipNotFound, ClipNotReady, and
    BadContent for an upload that cannot be used.
    """
    options = query.volumes
    described = describe(lib, query.source, (RHO, EPSILON))
    exclude = described.excluded_clips(include_self=query.include_self)
    ids = lib.index.candidates(clip_filter, exclude).ids
    load: Loader = partial(lib.arrays.get_many, lib.store)
    own = described.arrays
    if not options.are_stored:
        if len(ids) > MAX_CLIPS:
            name = "q" if options.q != 2 else "eta"
            detail = f"is computed for at most {MAX_CLIPS} clips, and {len(ids)} pass the filter"
            raise fields.bad_field(name, detail)
        load = partial(_factors, lib, options)
        packed = _packed(query_motion(lib, described), options)
        own = {RHO: packed[:JOINTS], EPSILON: packed[JOINTS:]}
    if method is Method.MSV_XCORR and options.normalized:
        distances = _normalized(own[RHO], own[EPSILON], list(ids), load)
    else:
        distances = distances_to(own, list(ids), method, load)
    is_stored = np.isfinite(distances)
    content = hashlib.sha256(own[RHO].tobytes() + own[EPSILON].tobytes()).hexdigest()
    digest = f"{content} {sorted(exclude)}"
    return VolumeRanking(Ranking(ids[is_stored], distances[is_stored]), digest)


def _normalized(
    rho: FloatArray, epsilon: FloatArray, clip_ids: Sequence[str], load: Loader
) -> FloatArray:
    """(n,) 3 - the length-normalized D_xcorr; infinity for clips without factors."""
    rhos, epsilons = load(clip_ids, RHO), load(clip_ids, EPSILON)
    rows = [row for row, one in enumerate(clip_ids) if one in rhos and one in epsilons]
    distances = np.full(len(clip_ids), np.inf)
    if rows:
        found = [clip_ids[row] for row in rows]
        likeness = cross_correlations(
            rho,
            epsilon,
            np.stack([rhos[one] for one in found]),
            [epsilons[one] for one in found],
            normalized=True,
        )
        distances[rows] = np.maximum(MAX_CROSS_CORRELATION - likeness, 0.0)
    return distances


def _factors(
    lib: Library, options: VolumeOptions, clip_ids: Sequence[str], name: str
) -> dict[str, FloatArray]:
    """RHO or EPSILON of clips with these options, computed or from memory."""
    key = f"msv q={options.q} eta={options.eta!r}"
    found = lib.arrays.get_made(clip_ids, key, partial(_made, lib, options))
    part = slice(0, JOINTS) if name == RHO else slice(JOINTS, None)
    return {clip_id: packed[part] for clip_id, packed in found.items()}


def _made(lib: Library, options: VolumeOptions, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    with lib.store.read() as tx:
        records = stored.get_many(tx, clip_ids)
    made = {}
    for clip_id, record in records.items():
        with lib.store.read() as tx:
            motion = read_motion(tx, record)
        made[clip_id] = _packed(motion, options)
    return made


def _packed(motion: Motion, options: VolumeOptions) -> FloatArray:
    """(13 + frames,) float32: rho, then epsilon."""
    factors = decompose(active_part(smooth_track(motion)), q=options.q, threshold=options.eta)
    return np.concatenate([factors.primary, factors.secondary]).astype(np.float32)
