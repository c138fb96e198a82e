"""Fills long gaps of a marker from the markers that move with it.

Markers on one segment of the body keep their distances. With three of them that are seen, the place
of a hidden one follows: their turn from the last frame before the gap, and from the first frame
after it, moves the hidden marker too (least squares, Kabsch 1976). With one or two, only their
shift is known. The two predictions are blended. Long gaps are filled only by markers of a part of
the body that is known to be rigid (head, pelvis, trunk): a hand that hangs beside the hip also
keeps its distance from it, until it moves.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from app.deadline import check
from app.motion.roles.marker_names import place_on_body
from app.motion.skeleton.occlusion import Gap
from app.numerics.arrays import BoolArray, FloatArray, IntArray

MAX_RIGID_GAP, MAX_NEAR_GAP = 5.0, 0.75
"""Seconds: the longest gaps that are filled by markers of a rigid part, and by other neighbors."""
MAX_DISTANCE, MAX_DISTANCE_CHANGE = 0.2, 0.006
"""The largest distance of neighbors, and its largest standard deviation, as shares of the size of
the body: about 35 cm and 1 cm. Skin moves over the bone by about 1 cm."""
RIGID_PARTS = (
    ("LFHD", "RFHD", "LBHD", "RBHD", "TOPHD", "FRONTHD", "REARHD"),
    ("LASI", "RASI", "LPSI", "RPSI", "SACR"),
    ("C7", "T10", "CLAV", "STRN"),
)
"""The places of markers on parts of the body that are rigid."""
MIN_COMMON_FRAMES = 10
"""The fewest frames in which two markers must be seen together."""
MAX_DONORS = 6
MIN_SPREAD = 0.05
"""The smallest second singular value of three neighbors, as a share of the first. Below it, they
are on a line, about which the turn is unknown."""
MAX_COMPARED_FRAMES, MAX_MEASURED_FRAMES = 500, 50
"""About the number of frames, evenly spaced, in which distances are compared, and in which the size
of the body is measured."""


def fill_by_neighbors(
    labels: Sequence[str], positions: FloatArray, gaps: Sequence[Gap], frame_rate: float
) -> FloatArray:
    """The positions with more gaps filled.

    labels: (markers,). positions: (frames, markers, 3), NaN in the gaps. frame_rate: Hz.
    """
    filled = positions.copy()
    seen = np.isfinite(positions[..., 0])
    size = _size(positions) if gaps else 0.0
    parts = [_part(label) for label in labels]
    for gap in gaps:
        check()
        length = gap.end - gap.start
        if length > MAX_RIGID_GAP * frame_rate:
            continue
        donors = _donors(positions, seen, gap, size)
        if length > MAX_NEAR_GAP * frame_rate:
            part = parts[gap.marker]
            donors = np.array([d for d in donors if part >= 0 and parts[d] == part], np.int64)
        is_rigid = len(donors) >= 3
        if not len(donors) or (not is_rigid and length > MAX_NEAR_GAP * frame_rate):
            continue
        predicted = _predicted(positions, seen, gap, donors if is_rigid else donors[:1])
        if predicted is not None:
            filled[gap.start : gap.end, gap.marker] = predicted
    return filled


def _part(label: str) -> int:
    """The index of the rigid part on which a marker is; -1 if there is none."""
    place = place_on_body(label)
    return next((index for index, part in enumerate(RIGID_PARTS) if place in part), -1)


def _size(positions: FloatArray) -> float:
    """The diagonal of the body: of the box around the mean positions of its markers."""
    some = positions[:: max(1, len(positions) // MAX_MEASURED_FRAMES)]
    # Relative to the middle of all markers, so that the way through the room does not count.
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # markers that are not seen in any frame
        middle = np.nanmean(some, axis=1, keepdims=True)
        usual = np.nanmean(some - middle, axis=0)
    usual = usual[np.isfinite(usual).all(axis=-1)]
    return float(np.linalg.norm(np.ptp(usual, axis=0))) if len(usual) else 0.0


def _donors(positions: FloatArray, seen: BoolArray, gap: Gap, size: float) -> IntArray:
    """The markers that keep their distance from the hidden one, the steadiest first.

    All are seen in the whole gap, and in the frames at its ends.
    """
    first, last = max(gap.start - 1, 0), min(gap.end + 1, len(seen))
    there = np.flatnonzero(seen[first:last].all(axis=0))
    frames = np.flatnonzero(seen[:, gap.marker])
    frames = frames[:: max(1, len(frames) // MAX_COMPARED_FRAMES)]
    if len(frames) < MIN_COMMON_FRAMES or not len(there):
        return np.zeros(0, dtype=np.int64)
    away = positions[np.ix_(frames, there)] - positions[frames, None, gap.marker]
    distances = np.linalg.norm(away.astype(np.float64), axis=-1)
    common = np.isfinite(distances)
    enough = common.sum(axis=0) >= MIN_COMMON_FRAMES
    with np.errstate(invalid="ignore", divide="ignore"):
        weights = common / np.maximum(common.sum(axis=0), 1)
        known = np.where(common, distances, 0.0)
        mean = (known * weights).sum(axis=0)
        spread = np.sqrt((np.where(common, (distances - mean) ** 2, 0.0) * weights).sum(axis=0))
    steady = enough & (mean <= MAX_DISTANCE * size) & (spread <= MAX_DISTANCE_CHANGE * size)
    order = np.argsort(spread[steady], kind="stable")
    return np.asarray(there[steady][order][:MAX_DONORS])


def _predicted(
    positions: FloatArray, seen: BoolArray, gap: Gap, donors: IntArray
) -> FloatArray | None:
    """(frames of the gap, 3) the hidden marker; None if the neighbors do not determine it."""
    edges = [
        edge
        for edge in (gap.start - 1, gap.end)
        if 0 <= edge < len(seen) and seen[edge, gap.marker]
    ]
    found = []
    for edge in edges:
        moved = _moved(positions, gap, donors, edge)
        if moved is None:
            return None
        found.append(moved)
    if len(found) < 2:
        return found[0] if found else None
    after = np.arange(1, gap.end - gap.start + 1)[:, None] / (gap.end - gap.start + 1)
    return np.asarray(found[0] * (1 - after) + found[1] * after)


def _moved(positions: FloatArray, gap: Gap, donors: IntArray, edge: int) -> FloatArray | None:
    """(frames of the gap, 3) the marker as the neighbors move it from the frame `edge`."""
    then = positions[edge, donors].astype(np.float64)
    now = positions[gap.start : gap.end, donors].astype(np.float64)
    before, after = then.mean(axis=0), now.mean(axis=1)
    offset = positions[edge, gap.marker].astype(np.float64) - before
    if len(donors) < 3:
        return np.asarray(after + offset)
    sizes = np.linalg.svd(then - before, compute_uv=False)
    if sizes[1] < MIN_SPREAD * sizes[0]:
        return None
    # Kabsch: the turn of the neighbors' shape, without a mirror.
    left, _, right = np.linalg.svd(np.swapaxes(now - after[:, None], 1, 2) @ (then - before))
    mirrored = np.linalg.det(left @ right) < 0
    left[mirrored, :, 2] *= -1
    return np.asarray(after + (left @ right) @ offset)
