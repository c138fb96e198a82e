"""Places of a clip where a pose is taken, from the distances of its frames."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.pose.pose_places import SAME_PLACE, Places, PosePlace, pose_places

CURVES = st.lists(
    st.sampled_from([0.0, 0.02, 0.04, 0.1, 0.13, 0.3, np.inf]), min_size=1, max_size=40
)


def test_the_frames_around_the_best_are_its_place() -> None:
    curve = np.array([0.3, 0.14, 0.12, 0.1, 0.13, 0.2, 0.11, 0.4])
    assert pose_places(curve, Places.BEST) == [PosePlace(0.1, 3, 1, 4)]
    (place,) = pose_places(curve, Places.BEST)
    assert (place.time, place.start, place.end) == pytest.approx((3 / 30, 1 / 30, 5 / 30))


def test_a_cycle_takes_the_pose_again_and_again() -> None:
    phase = 2 * np.pi * np.arange(120) / 30
    found = pose_places(0.2 - 0.2 * np.cos(phase), Places.ALL)
    assert [place.frame for place in found] == [0, 30, 60, 90, 119]
    assert found[0].first == 0


def test_what_shakes_by_less_is_one_place() -> None:
    shaking = 0.1 + 0.4 * SAME_PLACE * (np.arange(50) % 2)
    assert len(pose_places(shaking, Places.ALL)) == 1
    assert pose_places(np.full(9, 0.25), Places.ALL) == [PosePlace(0.25, 0, 0, 8)]


def test_a_clip_with_no_pose_of_any_size_has_no_place() -> None:
    assert pose_places(np.full(5, np.inf), Places.ALL) == []
    assert pose_places(np.array([np.inf, 0.5, np.inf]), Places.ALL) == [PosePlace(0.5, 1, 1, 1)]


@given(CURVES)
def test_places_are_apart_and_the_best_is_one_of_them(curve: list[float]) -> None:
    distances = np.array(curve)
    found = pose_places(distances, Places.ALL)
    best = pose_places(distances, Places.BEST)
    if not np.isfinite(distances).any():
        assert found == best == []
        return
    assert best[0] in found
    for place in found:
        assert place.first <= place.frame <= place.last
        inside = distances[place.first : place.last + 1]
        assert place.distance == inside.min() == distances[place.frame]
        assert inside.max() <= place.distance + SAME_PLACE + 1e-9
    for one, other in pairwise(found):
        ridge = distances[one.last + 1 : other.first]
        assert len(ridge)
        assert ridge.max() > max(one.distance, other.distance) + SAME_PLACE - 1e-9
