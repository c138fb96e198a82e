"""The matches of a pose in a clip, from the distances of its frames."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.pose.pose_matches import MATCH_DEPTH, MatchesPerClip, PoseMatch, pose_matches

CURVES = st.lists(
    st.sampled_from([0.0, 0.02, 0.04, 0.1, 0.13, 0.3, np.inf]), min_size=1, max_size=40
)


def test_a_match_contains_the_frames_around_the_best() -> None:
    curve = np.array([0.3, 0.14, 0.12, 0.1, 0.13, 0.2, 0.11, 0.4])
    assert pose_matches(curve, MatchesPerClip.BEST) == [PoseMatch(0.1, 3, 1, 4)]
    (match,) = pose_matches(curve, MatchesPerClip.BEST)
    assert (match.time, match.start, match.end) == pytest.approx((3 / 30, 1 / 30, 5 / 30))


def test_each_cycle_has_a_match() -> None:
    phase = 2 * np.pi * np.arange(120) / 30
    found = pose_matches(0.2 - 0.2 * np.cos(phase), MatchesPerClip.ALL)
    assert [match.frame for match in found] == [0, 30, 60, 90, 119]
    assert found[0].first == 0


def test_small_changes_of_the_distance_do_not_split_a_match() -> None:
    shaking = 0.1 + 0.4 * MATCH_DEPTH * (np.arange(50) % 2)
    assert len(pose_matches(shaking, MatchesPerClip.ALL)) == 1
    assert pose_matches(np.full(9, 0.25), MatchesPerClip.ALL) == [PoseMatch(0.25, 0, 0, 8)]


def test_a_clip_with_only_poses_of_size_zero_has_no_match() -> None:
    assert pose_matches(np.full(5, np.inf), MatchesPerClip.ALL) == []
    assert pose_matches(np.array([np.inf, 0.5, np.inf]), MatchesPerClip.ALL) == [
        PoseMatch(0.5, 1, 1, 1)
    ]


@given(CURVES)
def test_matches_do_not_overlap_and_include_the_best(curve: list[float]) -> None:
    distances = np.array(curve)
    found = pose_matches(distances, MatchesPerClip.ALL)
    best = pose_matches(distances, MatchesPerClip.BEST)
    if not np.isfinite(distances).any():
        assert found == best == []
        return
    assert best[0] in found
    for match in found:
        assert match.first <= match.frame <= match.last
        inside = distances[match.first : match.last + 1]
        assert match.distance == inside.min() == distances[match.frame]
        assert inside.max() <= match.distance + MATCH_DEPTH + 1e-9
    for one, other in pairwise(found):
        ridge = distances[one.last + 1 : other.first]
        assert len(ridge)
        assert ridge.max() > max(one.distance, other.distance) + MATCH_DEPTH - 1e-9
