"""What a collection covers, beside the library, and proposals of what is missing.

The library is read from at most MAX_COMPARED ready clips, evenly chosen by their ids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.coverage.coverage import ENOUGH_SECONDS, Coverage, coverage_of
from app.deadline import check
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import BoolArray, FloatArray
from app.numerics.euclidean import squared_distances
from app.search.index import usable_arrays
from app.services.collections.collections import Item, all_items
from app.services.library.library import Library
from app.store.clips import listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord, ClipState

MAX_COMPARED = 500
"""Clips of the library that are compared."""
MAX_POSES = 4000
"""Poses of the library, and of the collection, that are compared."""
NEAR_POSE = 0.1
"""Body lengths (RMS over the joints): a pose that is so near is covered."""
MAX_PROPOSALS = 10
BATCH = 50
POSITIONS, POSES = "role_positions", "pose_cover"


@dataclass(frozen=True, slots=True)
class Proposal:
    """What would fill cells: a clip of the library to add, or a clip of the collection to mirror.

    seconds: in cells that are not covered, at most ENOUGH_SECONDS of each.
    """

    clip: ClipRecord
    is_mirror: bool
    seconds: float


@dataclass(frozen=True, slots=True)
class Statistics:
    """own, library: coverage; clips, of_library: the number of clips that were read;
    pose_share: the share of the library's poses that are near one of the collection's; None if
    either has none; persons, tasks, licenses: items by label ("" for none)."""

    own: Coverage
    library: Coverage
    items: int
    clips: int
    of_library: int
    library_size: int
    pose_share: float | None
    seconds: float
    labels: Mapping[str, Mapping[str, int]]
    proposals: tuple[Proposal, ...]


def statistics(lib: Library, collection_id: str) -> Statistics:
    """The statistics of a collection. Raises CollectionNotFound."""
    items = [item for item in all_items(lib, collection_id) if item.clip.state is ClipState.READY]
    ids = list(dict.fromkeys(item.clip.id for item in items))
    with lib.store.read() as tx:
        ready = sorted(listing.list_ids(tx, ClipFilter(state=(ClipState.READY,))))
    chosen = [ready[i] for i in _evenly(len(ready), MAX_COMPARED)]
    by_clip, poses = _read(lib, list(dict.fromkeys([*ids, *chosen])))
    own = [_of_item(item, by_clip) for item in items]
    whole = {clip_id: coverage_of(found) for clip_id, found in by_clip.items()}
    total, library = _sum(own), _sum([whole[i] for i in chosen if i in whole])
    return Statistics(
        own=total,
        library=library,
        items=len(items),
        clips=len(ids),
        of_library=len(chosen),
        library_size=len(ready),
        pose_share=_pose_share(items, chosen, poses),
        seconds=sum(item.seconds for item in items),
        labels=_labels(items),
        proposals=_proposals(lib, total, whole, ids),
    )


def _evenly(count: int, most: int) -> list[int]:
    chosen = np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))
    return [int(index) for index in chosen]


def _read(
    lib: Library, clip_ids: Sequence[str]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Positions and representative poses, by clip id."""
    positions: dict[str, FloatArray] = {}
    poses: dict[str, FloatArray] = {}
    for batch in clips.in_batches(clip_ids, BATCH):
        check()
        with lib.store.read() as tx:
            positions |= usable_arrays.get_many(tx, batch, POSITIONS)
            poses |= usable_arrays.get_many(tx, batch, POSES)
    return positions, poses


def _of_item(item: Item, positions: Mapping[str, FloatArray]) -> Coverage:
    found = positions.get(item.clip.id)
    return Coverage.nothing() if found is None else coverage_of(found[_frames(item, len(found))])


def _frames(item: Item, count: int) -> slice:
    end = item.record.end
    stop = count if end is None else min(count, round(end * ANALYSIS_RATE))
    return slice(round((item.record.start or 0.0) * ANALYSIS_RATE), stop)


def _sum(parts: Sequence[Coverage]) -> Coverage:
    total = Coverage.nothing()
    for one in parts:
        total = total + one
    return total


def _pose_share(
    items: Sequence[Item], chosen: Sequence[str], poses: Mapping[str, FloatArray]
) -> float | None:
    own = [_poses_of(item, poses[item.clip.id]) for item in items if item.clip.id in poses]
    every = [poses[clip_id][:, 2:] for clip_id in chosen if clip_id in poses]
    if not sum(map(len, own)) or not sum(map(len, every)):
        return None
    ours, theirs = (_thinned(np.concatenate(some)) for some in (own, every))
    squares = np.einsum("ij,ij->i", ours, ours)
    nearest = squared_distances(theirs, ours, squares).min(axis=1)
    return float(np.mean(nearest <= NEAR_POSE**2))


def _poses_of(item: Item, rows: FloatArray) -> FloatArray:
    """(k, 36) the poses of an item: those of its part. The first column is the frame at 30 Hz."""
    part = _frames(item, int(rows[:, 0].max(initial=0)) + 1)
    is_in: BoolArray = (rows[:, 0] >= part.start) & (rows[:, 0] < part.stop)
    return rows[is_in, 2:]


def _thinned(rows: FloatArray) -> FloatArray:
    return rows[_evenly(len(rows), MAX_POSES)].astype(np.float32)


def _labels(items: Sequence[Item]) -> dict[str, dict[str, int]]:
    counts: dict[str, dict[str, int]] = {}
    for name in ("person", "task", "license"):
        own = counts.setdefault(name, {})
        for item in items:
            label = getattr(item.clip, name) or ""
            own[label] = own.get(label, 0) + 1
    return counts


def _proposals(
    lib: Library, own: Coverage, by_clip: Mapping[str, Coverage], ids: Sequence[str]
) -> tuple[Proposal, ...]:
    """The clips that fill most, one after the other: each fills what the earlier ones left."""
    mirrored = {(i, True): by_clip[i].mirrored() for i in ids if i in by_clip}
    others = {(i, False): one for i, one in by_clip.items() if i not in ids}
    candidates = mirrored | others
    lacking = np.maximum(ENOUGH_SECONDS - own.cells, 0.0)
    chosen: list[tuple[str, bool, float]] = []
    while candidates and len(chosen) < MAX_PROPOSALS:
        check()
        gains = {key: _gain(one, lacking) for key, one in candidates.items()}
        best = max(gains, key=lambda key: (gains[key], key))
        if gains[best] < ENOUGH_SECONDS / 2:
            break
        chosen.append((*best, gains[best]))
        lacking = np.maximum(lacking - candidates.pop(best).cells, 0.0)
    with lib.store.read() as tx:
        found = clips.get_many(tx, dict.fromkeys(clip_id for clip_id, _, _ in chosen))
    return tuple(Proposal(found[i], mirror, gain) for i, mirror, gain in chosen if i in found)


def _gain(one: Coverage, lacking: FloatArray) -> float:
    return float(np.minimum(one.cells, lacking).sum())
