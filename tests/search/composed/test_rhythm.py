"""Rhythms: the rate, its half, the tolerance, and clips that do not repeat themselves."""

from __future__ import annotations

import numpy as np
import pytest

from app.search.composed.rhythm import rhythm_probabilities


def test_the_score_is_the_cyclicity_at_the_rate_and_half_of_it_at_the_tolerance() -> None:
    times = 60.0 / np.array([100.0, 50.0, 110.0, 100.0 / 1.1, 150.0, np.nan])
    cyclicity = np.array([0.9, 0.8, 1.0, 1.0, 1.0, 1.0])
    found = rhythm_probabilities(times, cyclicity, 100.0, 0.1)
    assert found[:4] == pytest.approx([0.9, 0.8, 0.5, 0.5])
    assert found[4] < 0.01
    assert found[5] == 0.0


def test_clips_without_a_cycle_have_none() -> None:
    found = rhythm_probabilities(np.array([0.0, 1.0]), np.array([1.0, np.nan]), 60.0, 0.2)
    assert found.tolist() == [0.0, 0.0]
    negative = rhythm_probabilities(np.array([1.0]), np.array([-0.3]), 60.0, 0.2)
    assert negative.tolist() == [0.0]
