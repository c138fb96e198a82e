"""Moments: curves from windows, their peaks, and the order of the peaks of all clips."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from app.numerics.arrays import FloatArray
from app.search.windows.moments import RELATIVE, STEP, nearest_moments, on_grid, peaks_of
from app.search.windows.stretches import even_stretches

CURVES = arrays.arrays(np.float64, st.integers(1, 30), elements=st.floats(0, 1, width=16))


def slow_curve(starts: FloatArray, ends: FloatArray, values: FloatArray) -> FloatArray:
    """The curve of one clip, point by point and window by window."""
    curve = []
    for point in range(max(int(np.ceil(ends.max() / STEP)), 1)):
        at, means = min((point + 0.5) * STEP, ends.max()), []
        for length in {round(length / STEP) for length in ends - starts}:
            near, sums = 0.0, 0.0
            for start, end, value in zip(starts, ends, values, strict=True):
                if round((end - start) / STEP) == length and start <= at <= end:
                    weight = max(1 - abs(at - (start + end) / 2) / ((end - start) / 2), 1e-3)
                    near, sums = near + weight, sums + weight * value
            if near:
                means.append(sums / near)
        curve.append(np.mean(means) if means else 0.0)
    return np.array(curve)


def test_curves_are_those_of_a_slow_twin() -> None:
    rng = np.random.default_rng(1)
    owners, starts, ends, values = [], [], [], []
    for clip in (0, 2, 5):  # other clips have no windows
        seconds = rng.uniform(4.0, 9.0)
        for length, hop in ((2.0, 0.5), (4.0, 1.0)):
            for start in np.append(np.arange(0, seconds - length, hop), seconds - length):
                owners.append(clip)
                starts.append(start)
                ends.append(start + length)
                values.append(rng.uniform())
    columns = np.array(owners), np.array(starts), np.array(ends), np.array(values)
    ids = np.array([f"clip_{number}" for number in range(6)], dtype=object)
    curves = on_grid(ids, *columns)
    assert curves.ids.tolist() == ["clip_0", "clip_2", "clip_5"]
    for number, clip in enumerate((0, 2, 5)):
        own = columns[0] == clip
        expected = slow_curve(*(column[own] for column in columns[1:]))
        found = curves.values[curves.firsts[number] : curves.firsts[number + 1]]
        assert found == pytest.approx(expected)


def test_a_curve_goes_on_to_the_end_of_a_clip_that_ends_early_in_a_step() -> None:
    starts = np.array([0.0, 1.05])
    curves = on_grid(
        np.array(["clip"], dtype=object), np.array([0, 0]), starts, starts + 2, np.array([0.3, 0.8])
    )
    assert len(curves.values) == 13  # the last step begins at 3 s, the clip ends at 3.05 s
    assert curves.values[-1] == pytest.approx(0.8)


@given(CURVES)
def test_peaks_do_not_overlap_and_stay_above_a_share_of_their_top(curve: FloatArray) -> None:
    found = peaks_of(curve)
    taken = np.zeros(len(curve), dtype=bool)
    tops = []
    for first, stop in found:
        assert not taken[first:stop].any()
        taken[first:stop] = True
        top = curve[first:stop].max()
        assert (curve[first:stop] >= RELATIVE * top).all()
        tops.append(top)
    assert tops == sorted(tops, reverse=True)
    if curve.max() > 1e-3:
        first, stop = found[0]
        assert first <= int(np.argmax(curve)) < stop


@given(st.lists(CURVES, min_size=1, max_size=5))
def test_moments_of_all_clips_come_in_order(curves: list[FloatArray]) -> None:
    owners, starts, values = [], [], []
    for number, curve in enumerate(curves):
        owners += [number] * len(curve)
        starts += [STEP * point for point in range(len(curve))]
        values += curve.tolist()
    begin = np.array(starts)
    ids = np.array([f"clip_{number}" for number in range(len(curves))], dtype=object)
    grid = on_grid(ids, np.array(owners), begin, begin + STEP, np.array(values))
    found = list(nearest_moments(grid))
    distances = [(one.distance, one.key) for one in found]
    assert distances == sorted(distances)
    assert len(found) == sum(len(peaks_of(curve)) for curve in curves)


def test_stretches_end_where_something_else_is_probable() -> None:
    curve = np.zeros((30, 2))
    curve[:12, 0] = 0.9
    curve[12:20, 1] = 0.8
    assert even_stretches(curve) == [(0, 12), (12, 20), (20, 30)]
    assert even_stretches(np.zeros((5, 2))) == [(0, 5)]
    assert even_stretches(np.zeros((1, 2))) == [(0, 1)]
