"""The tracker of beats against a slow twin."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.rhythm.beat_tracking import track

TIGHTNESS = 100.0


def slow_track(strength: np.ndarray, period: float) -> np.ndarray:
    """The twin of `track`: Ellis's recursion frame by frame."""
    nearest, furthest = max(1, round(0.5 * period)), round(2.0 * period)
    total, before = strength.copy(), np.full(len(strength), -1)
    for t in range(nearest, len(strength)):
        best = (0.0, -1)
        for gap in range(nearest, min(furthest, t) + 1):
            reached = total[t - gap] - TIGHTNESS * np.log(gap / period) ** 2
            if reached > best[0]:
                best = (reached, t - gap)
        total[t] += best[0]
        before[t] = best[1]
    last = max(0, len(strength) - round(period))
    beats = [last + int(total[last:].argmax())]
    while before[beats[-1]] >= 0:
        beats.append(int(before[beats[-1]]))
    return np.array(beats[::-1])


@pytest.mark.parametrize("period", [7.3, 25.0])
def test_tracking_by_blocks_equals_tracking_by_frames(period: float) -> None:
    strength = np.random.default_rng(5).gamma(0.4, 2.0, 400)
    fast, slow = track(strength, period, TIGHTNESS), slow_track(strength, period)
    np.testing.assert_array_equal(fast, slow)
