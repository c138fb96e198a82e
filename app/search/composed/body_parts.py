"""Examples of which only a part of the body counts: arms, legs, or all above the hips.

The second stage warps the features of these joints alone. The first one compares the mean and the
spread of each of their coordinates over the pose covers of the clips.
"""

from __future__ import annotations

import threading
from enum import StrEnum

import numpy as np

from app.analysis.descriptors.pose_cover import POSE_WIDTH
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.alignment.dtw import dtw_distances
from app.numerics.arrays import FloatArray, IntArray
from app.search.composed.by_parts import Evidence, SecondStage
from app.search.composed.likeness import (
    COSTLY_SAMPLE,
    CURVES,
    SAMPLE,
    even_sample,
    typical_distance,
)
from app.search.composed.surprise import Part
from app.search.example.distances import ACTIVE, FEATURES, Descriptors, Loader, active_frames
from app.search.example.methods import Method
from app.search.index.rows import RowsView
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray

COVER = "pose_cover"
_FACTS = 2
_ARMS = (
    JointRole.LEFT_ELBOW,
    JointRole.RIGHT_ELBOW,
    JointRole.LEFT_HAND,
    JointRole.RIGHT_HAND,
)
_LEGS = (JointRole.LEFT_KNEE, JointRole.RIGHT_KNEE, JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT)


class BodyPart(StrEnum):
    """The part of the body of an example that counts."""

    ARMS = "arms"
    LEGS = "legs"
    UPPER_BODY = "upper_body"


JOINTS: dict[BodyPart, tuple[int, ...]] = {
    BodyPart.ARMS: tuple(SUN_ROLES.index(role) for role in _ARMS),
    BodyPart.LEGS: tuple(SUN_ROLES.index(role) for role in _LEGS),
    BodyPart.UPPER_BODY: tuple(
        index for index, role in enumerate(SUN_ROLES) if role not in (*_LEGS, JointRole.HIPS)
    ),
}
"""The joints of each part, by their index in SUN_ROLES."""
_COVERED = [index for index, role in enumerate(SUN_ROLES) if role is not JointRole.HIPS]


def feature_columns(part: BodyPart) -> IntArray:
    """The columns of features (n, 82): positions and velocities of the joints of a part."""
    joints = np.array(JOINTS[part])
    positions = (3 * joints[:, None] + np.arange(3)).ravel()
    return np.concatenate([positions, positions + 3 * len(SUN_ROLES)])


def summary_columns(part: BodyPart) -> IntArray:
    """The columns of `summary` (72,): mean and spread of the coordinates of a part."""
    joints = np.array([_COVERED.index(joint) for joint in JOINTS[part]])
    means = (3 * joints[:, None] + np.arange(3)).ravel()
    return np.concatenate([means, means + POSE_WIDTH])


def summary(cover: FloatArray) -> FloatArray:
    """(72,) mean and standard deviation of the poses of a cover (k, 38), k >= 1."""
    poses = cover[:, _FACTS:].astype(np.float64)
    return np.concatenate([poses.mean(axis=0), poses.std(axis=0)])


class PoseSummaries:
    """The summaries of all clips in a view of an index of poses, kept until the view changes."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: tuple[int, int, FloatArray] | None = None

    def of(self, version: int, view: RowsView) -> FloatArray:
        """(n, 72) float32; infinity for clips without poses. version: of the library."""
        key = version, len(view.labels.ids)
        with self._lock:
            if self._kept is None or self._kept[:2] != key:
                self._kept = (*key, _summaries(view))
            return self._kept[2]


def _summaries(view: RowsView) -> FloatArray:
    if view.starts is None or view.owners is None or not len(view.starts):
        return np.zeros((0, 2 * POSE_WIDTH), dtype=np.float32)
    sums = np.zeros((2, len(view.starts), POSE_WIDTH))
    first = 0
    for block in view.blocks:
        own = view.owners[first : first + len(block)]
        begins = np.flatnonzero(np.diff(own, prepend=-1))
        poses = block.vectors.astype(np.float64)
        sums[0, own[begins]] += np.add.reduceat(poses, begins)
        sums[1, own[begins]] += np.add.reduceat(poses**2, begins)
        first += len(block)
    counts = np.diff(view.starts, append=first)[:, None]
    means = sums[0] / counts
    spreads = np.sqrt(np.maximum(sums[1] / counts - means**2, 0.0))
    return np.hstack([means, spreads]).astype(np.float32)


SCALE_COUNT = 2
"""The number of typical distances of an example of which a part counts."""


def part_scales(
    body_part: BodyPart, query: Descriptors, summaries: FloatArray, view: RowsView, load: Loader
) -> tuple[float, ...]:
    """The typical distances of an example: of summaries, and of warping.

    query: with COVER, FEATURES and ACTIVE; summaries: of `PoseSummaries`, of all clips in `view`.
    They come from samples of all clips, as those of whole bodies.
    """
    living = np.flatnonzero(view.labels.alive)
    apart = _apart(body_part, query, summaries, even_sample(living, SAMPLE))
    ids = view.labels.ids[even_sample(living, COSTLY_SAMPLE)]
    warped = _Warping(body_part, query, load).distances(ids)
    return typical_distance(apart), typical_distance(warped)


def part_evidence(
    part: Part,
    body_part: BodyPart,
    query: Descriptors,
    summaries: FloatArray,
    places: IntArray,
    scales: tuple[float, ...],
    load: Loader,
) -> Evidence:
    """The probabilities that a part of the body moves like that of an example.

    query, summaries: as in `part_scales`; places: (k,) the rows of the clips in the summaries, -1
    for none; scales: of `part_scales`. The curves are those of whole bodies.
    """
    by_vector, by_warping = scales
    apart = np.full(len(places), np.inf)
    apart[places >= 0] = _apart(body_part, query, summaries, places[places >= 0])
    fast = CURVES[Method.VECTOR].probabilities(apart, by_vector)

    def likely(distances: FloatArray) -> FloatArray:
        return CURVES[Method.DTW].probabilities(distances, by_warping)

    return Evidence(part, fast, SecondStage(_Warping(body_part, query, load).bounds, likely))


def _apart(
    body_part: BodyPart, query: Descriptors, summaries: FloatArray, rows: IntArray
) -> FloatArray:
    """(k,) distances of an example to the `rows` (k,) of the summaries, by a part of the body."""
    columns = summary_columns(body_part)
    cover = query[COVER]
    if not len(cover):
        return np.full(len(rows), np.inf)
    own = summary(cover)[columns].astype(np.float32)
    return np.asarray(np.linalg.norm(summaries[rows][:, columns] - own, axis=1))


class _Warping:
    """The warping distances of clips to an example, by the joints of a part."""

    def __init__(self, body_part: BodyPart, query: Descriptors, load: Loader) -> None:
        self._columns = feature_columns(body_part)
        self._query = self._frames(query[FEATURES], query[ACTIVE])
        self._load = load

    def bounds(self, ids: IdArray) -> LowerBounds:
        """All clips, none of which is measured yet."""
        return LowerBounds(ids, np.zeros(len(ids)), lambda rows: self.distances(ids[rows]))

    def distances(self, ids: IdArray) -> FloatArray:
        """(m,) the distances of the clips `ids` (m,), infinity for those that are gone."""
        names = ids.tolist()
        features, spans = self._load(names, FEATURES), self._load(names, ACTIVE)
        there = [row for row, one in enumerate(names) if one in features and one in spans]
        found = np.full(len(names), np.inf)
        clips = [self._frames(features[names[row]], spans[names[row]]) for row in there]
        if clips:
            found[there] = dtw_distances(self._query, clips)
        return found

    def _frames(self, features: FloatArray, span: FloatArray) -> FloatArray:
        return np.ascontiguousarray(active_frames(features, span)[:, self._columns])
