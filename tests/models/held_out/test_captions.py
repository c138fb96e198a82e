"""Captions are judged by the protocols of text-to-motion retrieval."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.models.held_out.captions import (
    BATCH,
    BATCHES,
    caption_figures,
    caption_likeness,
    ranks,
)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 8))
def test_a_rank_is_the_mean_over_the_orders_of_equal_clips(
    seed: int, rows: int, clips: int
) -> None:
    rng = np.random.default_rng(seed)
    scores = rng.integers(0, 3, size=(rows, clips)).astype(float)
    right = rng.random((rows, clips)) < 0.4
    right[:, 0] = True
    slow = []
    for row in range(rows):
        orders = [rng.permutation(clips) for _ in range(4000)]
        sorted_ = [order[np.argsort(-scores[row, order], kind="stable")] for order in orders]
        slow.append(np.mean([np.flatnonzero(right[row, one])[0] + 1 for one in sorted_]))
    np.testing.assert_allclose(ranks(scores, right), slow, atol=0.2)


def test_captions_of_the_same_words_are_alike() -> None:
    captions = ["a man walks", "somebody is walking", "he kicks a ball", "xyz", "the"]
    likeness = caption_likeness(captions)
    np.testing.assert_allclose(np.diagonal(likeness), 1.0)
    np.testing.assert_array_equal(likeness, likeness.T)
    assert likeness[0, 1] == pytest.approx(1.0)
    assert likeness[0, 2] == likeness[3, 4] == 0.0


def test_every_protocol_has_its_trials_and_its_chance() -> None:
    rng = np.random.default_rng(0)
    captions = ["walks", "he walks", "kicks", "jumps high", "jumps high", "waves"]
    own = np.array([0, 1, 2, 3, 3, 5])
    scores = rng.random((6, 40)) * 0.5
    scores[np.arange(6), own] = [1.0, 0.4, 1.0, 1.0, 1.0, 1.0]
    scores[1, 0] = 1.0  # the clip of another caption that says the same
    all_, threshold, distinct, batches = caption_figures(scores, own, captions)
    assert [one.protocol for one in (all_, threshold, distinct, batches)] == [
        "all", "threshold", "distinct", "batches",
    ]  # fmt: skip
    assert (all_.captions, all_.clips) == (6, 40)
    assert all_.recalls[0] == pytest.approx(5 / 6)
    assert threshold.recalls[0] == 1.0
    assert (distinct.captions, distinct.clips) == (4, 4)
    assert distinct.median_rank == 1.0
    assert (batches.captions, batches.clips) == (6 * BATCHES, BATCH)
    assert all_.chance_recalls == pytest.approx((1 / 40, 5 / 40, 10 / 40), abs=0.02)
    assert all_.chance_median_rank == pytest.approx(20.5, abs=1.0)
    assert batches.chance_recalls == pytest.approx((1 / 32, 5 / 32, 10 / 32), abs=0.02)


def test_a_model_that_knows_nothing_has_the_figures_of_chance() -> None:
    figures = caption_figures(np.zeros((3, 11)), np.array([0, 4, 9]), ["a", "b", "c"])
    assert figures[0].median_rank == 6.0
    assert figures[0].recalls[:2] == (0.0, 0.0)
