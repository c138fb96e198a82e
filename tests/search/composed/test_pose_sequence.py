"""Sequences of poses compared with all ways to choose frames."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.search.composed.pose_sequence import same_clips, sequence_match
from app.search.index.labels import Labels
from tests.search.indexed import indexed


@given(st.integers(1, 3), st.integers(1, 6), st.integers(0, 1000))
def test_the_least_mean_is_that_of_all_ways(poses: int, frames: int, seed: int) -> None:
    distances = np.random.default_rng(seed).integers(0, 5, size=(poses, frames)).astype(float)
    ways = combinations_with_replacement(range(frames), poses)
    naive = min(np.mean([distances[p, f] for p, f in enumerate(way)]) for way in ways)
    found, chosen = sequence_match(distances)
    assert found == pytest.approx(naive)
    assert chosen == sorted(chosen)
    assert np.mean([distances[p, f] for p, f in enumerate(chosen)]) == pytest.approx(found)


def test_the_order_counts() -> None:
    there = np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]])
    assert sequence_match(there) == (0.0, [0, 2])
    assert sequence_match(there[::-1])[0] == 0.5


def test_clips_are_found_in_another_index() -> None:
    one, other = Labels(), Labels()
    one.add([indexed(name) for name in "abc"])
    other.add([indexed(name) for name in "abc"])
    numbers = np.array([0, 2])
    ids = one.view().ids[numbers]
    assert same_clips(one.view(), ids, numbers, other.view()).tolist() == [0, 2]
    other.remove(["a"])
    assert same_clips(one.view(), ids, numbers, other.view()).tolist() == [-1, 2]
    other.add([indexed("a")])
    assert same_clips(one.view(), ids, numbers, other.view()).tolist() == [3, 2]
