"""Pose search against every frame of every clip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.descriptors.pose_cover import pose_cover, pose_vectors
from app.search.index import rows as rows_module
from app.search.index.rows import Rows
from app.search.pose import by_pose
from app.search.pose.by_pose import POSES, POSITIONS, PoseHit, PoseRanking, pose_distances
from app.search.pose.pose_matches import MatchesPerClip, pose_matches
from app.search.ranking.cursor import Position, decode, digest, encode
from app.store.clips.filter import ClipFilter
from tests.bodies import standing, turned_about_y, walking, waving
from tests.search.indexed import indexed

QUESTION = digest("pose")


@pytest.fixture(autouse=True, scope="module")
def _small() -> object:
    """Small limits, so that clips extend over several blocks and are compared in several rounds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows_module, "BLOCK", 16)
        patch.setattr(by_pose, "MAX_CLIPS_AT_ONCE", 3)
        patch.setattr(by_pose, "FIRST_CLIPS", 2)
        patch.setattr(by_pose, "SORTED_FIRST", 4)
        yield


def _library(seed: int, count: int) -> dict[str, np.ndarray]:
    """Noisy, turned and moved clips that walk, wave or stand; some clips occur twice."""
    rng = np.random.default_rng(seed)
    made: dict[str, np.ndarray] = {}
    for number in range(count):
        kind = rng.integers(4)
        if kind == 3 and made:
            body = made[str(rng.choice(sorted(made)))]
        else:
            body = (walking, waving, lambda s: standing(int(30 * s)))[kind % 3](
                rng.uniform(0.2, 1.5)
            )
            body = body + 0.02 * rng.normal(size=(1, 13, 3))
        body = turned_about_y(body, rng.uniform(-3, 3)) * rng.uniform(0.8, 1.2)
        made[f"c{number:02d}"] = (body + rng.normal(size=3)).astype(np.float32)
    return made


class _Searched:
    """A ranking over a library. It records which clips were loaded."""

    def __init__(
        self, clips: Mapping[str, np.ndarray], query: np.ndarray, per_clip: MatchesPerClip
    ) -> None:
        self.clips = dict(clips)
        self.query = query
        self.per_clip = per_clip
        self.loaded: list[str] = []

    def load(self, clip_ids: Sequence[str], name: str) -> Mapping[str, np.ndarray]:
        assert name == POSITIONS
        self.loaded += clip_ids
        return {clip_id: self.clips[clip_id] for clip_id in clip_ids if clip_id in self.clips}

    def ranking(self, exclude: Sequence[str] = ()) -> PoseRanking:
        rows = Rows(POSES)
        none = np.zeros(0, dtype=int)
        rows.put([indexed(i, pose_cover(p, none)) for i, p in self.clips.items()])
        view = rows.view()
        mask = view.labels.mask(ClipFilter(), exclude)
        return PoseRanking(view, mask, self.query, self.load, self.per_clip)

    def naive(self) -> list[tuple[float, str]]:
        """The keys of the matches of all clips, computed from all frames."""
        return sorted(
            PoseHit(clip_id, match).key
            for clip_id, positions in self.clips.items()
            for match in pose_matches(pose_distances(positions, self.query), self.per_clip)
        )


def _some_pose(clips: Mapping[str, np.ndarray], seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    body = clips[str(rng.choice(sorted(clips)))]
    return pose_vectors(
        body[[rng.integers(len(body))]] + rng.choice([0.0, 0.05]) * rng.normal(size=(13, 3))
    )[0]


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 14),
    limit=st.integers(1, 6),
    per_clip=st.sampled_from(MatchesPerClip),
)
def test_all_pages_together_are_the_same_as_a_search_of_all_frames(
    seed: int, count: int, limit: int, per_clip: MatchesPerClip
) -> None:
    clips = _library(seed, count)
    searched = _Searched(clips, _some_pose(clips, seed), per_clip)
    found: list[tuple[float, str]] = []
    after: Position | None = None
    while True:
        page = searched.ranking().page(after, limit)
        found += [hit.key for hit in page.hits]
        if not page.more:
            break
        distance, key = found[-1]
        after = decode(encode(Position(len(found), distance, key), QUESTION), QUESTION)
    assert found == searched.naive()


def test_most_clips_are_never_loaded() -> None:
    clips = _library(5, 60)
    searched = _Searched(clips, pose_vectors(waving(1.0)[[12]])[0], MatchesPerClip.BEST)
    page = searched.ranking().page(None, 3)
    assert [hit.key for hit in page.hits] == searched.naive()[:3]
    assert len(set(searched.loaded)) == len(searched.loaded) < 30


def test_of_many_clips_with_the_same_pose_only_the_first_are_loaded() -> None:
    clips = {f"c{number:02d}": walking(1.0).astype(np.float32) for number in range(60)}
    searched = _Searched(clips, pose_vectors(clips["c00"][[12]])[0], MatchesPerClip.BEST)
    page = searched.ranking().page(None, 5)
    assert [hit.key for hit in page.hits] == searched.naive()[:5]
    assert page.more
    assert len(searched.loaded) < 15


def test_a_pose_finds_its_own_frame_at_distance_zero_also_when_turned_and_moved() -> None:
    clips = _library(1, 8) | {"own": walking(2.0).astype(np.float32)}
    elsewhere = turned_about_y(3.0 * clips["own"][[17]], 2.0) + np.array([4.0, 0.0, -9.0])
    searched = _Searched(clips, pose_vectors(elsewhere)[0], MatchesPerClip.BEST)
    (hit,) = searched.ranking().page(None, 1).hits
    assert (hit.clip_id, hit.match.frame) == ("own", 17)
    assert hit.match.distance < 1e-6
    searched.query = pose_vectors(clips["own"][[17]])[0]
    assert searched.ranking().page(None, 1).hits[0].match.distance == 0.0
    others = searched.ranking(exclude=["own"]).page(None, 100).hits
    assert {hit.clip_id for hit in others} == clips.keys() - {"own"}


def test_a_clip_that_is_deleted_during_the_search_is_left_out() -> None:
    clips = _library(2, 6)
    searched = _Searched(clips, _some_pose(clips, 2), MatchesPerClip.BEST)
    ranking = searched.ranking()
    searched.clips = {}
    assert ranking.page(None, 10).hits == ()


def test_an_empty_index_has_no_hits() -> None:
    searched = _Searched({}, np.zeros(36, dtype=np.float32), MatchesPerClip.BEST)
    page = searched.ranking().page(None, 10)
    assert (page.hits, page.more) == ((), False)
