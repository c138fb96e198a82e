"""Short gaps are filled near the true positions, and long gaps are reported."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.motion.skeleton.occlusion import MAX_GAP, Gap, fill_gaps, hidden, longest_gap, runs
from app.numerics.arrays import FloatArray


def circle(frames: int = 200) -> FloatArray:
    """(frames, 1, 3) a helix of 1 m radius, a turn in two seconds at 100 Hz, in millimeters."""
    t = np.arange(frames) * np.pi / 100
    return np.stack([np.cos(t), np.sin(t), t], axis=-1)[:, None] * 1000


@pytest.mark.parametrize("length", [1, 5, 25])
def test_a_short_gap_is_filled_near_the_truth(length: int) -> None:
    truth = circle()
    holed = truth.copy()
    holed[80 : 80 + length] = np.nan
    filled = fill_gaps(holed, 100.0)
    assert np.abs(filled.positions - truth).max() < 2.0
    assert filled.long_gaps == ()


def test_a_long_gap_is_reported_and_not_filled() -> None:
    holed = circle()
    holed[80:106] = np.nan
    holed[:3] = np.nan
    filled = fill_gaps(holed, 100.0)
    (gap,) = filled.long_gaps
    assert (gap.marker, gap.start, gap.end) == (0, 80, 106)
    assert np.isnan(filled.positions[80:106]).all()
    assert np.allclose(filled.positions[:3], holed[3])


@pytest.mark.parametrize("rate", [10.0, 50.0, 240.0])
def test_the_limit_of_gaps_is_in_seconds(rate: float) -> None:
    most = round(MAX_GAP * rate)
    for length, long_gaps in ((most, 0), (most + 1, 1)):
        holed = circle()
        holed[20 : 20 + length] = np.nan
        assert len(fill_gaps(holed, rate).long_gaps) == long_gaps


@settings(max_examples=60, deadline=None)
@given(st.lists(st.booleans(), min_size=1, max_size=60), st.integers(0, 1000))
def test_seen_positions_do_not_change_and_filled_ones_are_finite(
    flags: list[bool], seed: int
) -> None:
    truth = np.random.default_rng(seed).normal(size=(len(flags), 2, 3))
    holed = truth.copy()
    holed[np.array(flags), 0] = np.nan
    filled = fill_gaps(holed, 100.0)
    assert np.array_equal(filled.positions[:, 1], truth[:, 1])
    assert np.array_equal(filled.positions[~np.array(flags), 0], truth[~np.array(flags), 0])
    left = [gap.end - gap.start for gap in filled.long_gaps]
    if not all(flags):
        assert np.isnan(filled.positions[:, 0, 0]).sum() == sum(left)


@given(st.lists(st.booleans(), max_size=40))
def test_runs_agree_with_the_slow_twin(flags: list[bool]) -> None:
    slow: list[list[int]] = []
    for index, flag in enumerate(flags):
        if flag and index and flags[index - 1]:
            slow[-1][1] = index + 1
        elif flag:
            slow.append([index, index + 1])
    assert runs(np.array(flags, dtype=bool)) == slow


def gap_by_looking(unseen: list[list[bool]]) -> Gap | None:
    """A slow twin of `longest_gap`: it tries every marker and every pair of frames."""
    found: Gap | None = None
    for marker in range(len(unseen[0])):
        for start in range(len(unseen)):
            for end in range(start + 1, len(unseen) + 1):
                is_gap = all(unseen[frame][marker] for frame in range(start, end))
                if is_gap and (found is None or end - start > found.end - found.start):
                    found = Gap(marker, start, end)
    return found


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.booleans(), min_size=3, max_size=3), min_size=1, max_size=12))
def test_the_longest_gap_is_that_of_its_slow_twin(unseen: list[list[bool]]) -> None:
    assert longest_gap(np.array(unseen)) == gap_by_looking(unseen)


def test_a_marker_is_hidden_where_any_coordinate_is_missing() -> None:
    holed = circle(4)
    holed[1, 0, 2] = np.nan
    assert hidden(holed)[:, 0].tolist() == [False, True, False, False]
