from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.held_out import words as word_figures
from app.models.held_out.word_methods import landmarks_among
from app.models.held_out.words import held_out_word_figures
from app.models.words.symbol_space import LANDMARKS
from app.numerics.hmm.model import mean_trajectory
from tests.models.word_clips import word_clips


def test_every_method_beats_the_prior_on_separable_clips() -> None:
    symbols, statistics, words = word_clips(6)
    groups = [str(row) for row in range(len(words))]
    found = held_out_word_figures(symbols, statistics, words, groups)
    assert (found.clips, found.words, found.folds) == (24, 7, 5)
    figures = {one.method: one for one in found.figures}
    cca = ["cca", "cca-score", "cca-10", "cca-distance", "printed"]
    assert list(figures) == ["prior", "default", *cca]
    assert figures["default"].word_f > figures["prior"].word_f
    assert figures["default"].top_3_recognition > 0.9
    assert figures["default"].set_map > figures["prior"].set_map + 0.1
    assert figures["cca"].set_map > figures["prior"].set_map + 0.1


def test_copies_of_a_recording_are_in_one_fold() -> None:
    """Each recording twice under one group: its words, which no other has, stay unknown."""
    symbols, statistics, _ = word_clips(2)
    words = [(f"only_{row}",) for row in range(8)]
    groups = [f"r{row}" for row in range(8)]
    figures = held_out_word_figures(symbols * 2, [*statistics] * 2, words * 2, groups * 2).figures
    assert all(one.top_3_recognition == 0.0 for one in figures if one.method == "default")


def test_unlabeled_clips_do_not_count_and_large_libraries_are_sampled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    symbols, statistics, words = word_clips(4)
    groups = [str(row) for row in range(len(words))]
    words[0] = words[5] = ()
    assert held_out_word_figures(symbols, statistics, words, groups).clips == 14
    monkeypatch.setattr(word_figures, "MAX_CLIPS", 9)
    assert held_out_word_figures(symbols, statistics, words, groups).clips == 9


@pytest.mark.parametrize("count", [0, 1, 3])
def test_too_few_clips_are_refused(count: int) -> None:
    symbols, statistics, words = word_clips(1)
    with pytest.raises(NotEnoughLabels):
        held_out_word_figures(symbols[:count], statistics[:count], words[:count], ["a"] * count)


def test_each_word_is_judged_and_rare_words_are_marked() -> None:
    symbols, statistics, words = word_clips(6)
    groups = [str(row // 2) for row in range(len(words))]
    found = held_out_word_figures(symbols, statistics, words, groups)
    wave = found.by_word[0]
    assert (wave.word, wave.clips, wave.too_rare) == ("wave", 6, False)
    assert wave.area_under_curve > 0.9
    stroll = next(one for one in found.by_word if one.word == "stroll")
    assert (stroll.clips, stroll.recordings, stroll.too_rare) == (3, 3, True)


def test_curves_correlations_and_reliability_are_reported() -> None:
    symbols, statistics, words = word_clips(6)
    found = held_out_word_figures(symbols, statistics, words, [str(i) for i in range(len(words))])
    for one in (*found.figures, *found.in_sample):
        assert len(one.precision) == len(word_figures.RECALLS)
        assert one.precision[-1] > 0.0
    held, seen = ({f.method: f for f in part} for part in (found.figures, found.in_sample))
    assert seen["default"].set_map >= held["default"].set_map
    assert list(found.reliability) == ["default", "cca-score"]
    assert found.left_out == {}
    assert list(found.losses) == [10]
    for told in found.reliability.values():
        assert told.word_brier < told.prior_brier
        assert 0.0 <= told.word_error < 0.2
    left_out = held_out_word_figures(
        symbols, statistics, words, [str(i) for i in range(len(words))], leave_one_out=True
    ).left_out
    assert left_out["cca"] > 0.8
    assert 0.2 < left_out["printed"] <= 1.0
    printed, ridged = (found.correlations[kind] for kind in ("pseudo_inverse", "ridge"))
    assert list(printed) == sorted(printed, reverse=True)
    assert all(one <= other + 1e-9 for one, other in zip(ridged, printed, strict=True))


def test_recognition_through_the_likeliest_symbol_needs_the_motions() -> None:
    symbols, statistics, words = word_clips(6)
    motions = [mean_trajectory(symbol) for symbol in symbols]
    groups = [str(row) for row in range(len(words))]
    words[1] = ()  # rows of the clips that are judged are not those of all clips
    found = held_out_word_figures(
        symbols, statistics, words, groups, sequence=lambda row: motions[row]
    )
    figures = {one.method: one for one in found.figures}
    assert list(figures)[-1] == "cca-symbol"
    # motions that can be told apart go to a symbol of their own kind
    assert abs(figures["cca-symbol"].top_3_recognition - figures["cca"].top_3_recognition) < 0.1
    crossed = held_out_word_figures(
        symbols, statistics, words, groups, sequence=lambda row: motions[(row + 1) % len(motions)]
    )
    assert crossed.figures[-1].top_3_recognition < figures["cca-symbol"].top_3_recognition - 0.2


def test_folds_of_a_large_library_share_most_of_their_landmarks() -> None:
    folds = np.arange(400) % 5
    chosen = [landmarks_among(np.flatnonzero(folds != one), 400) for one in range(5)]
    for one, landmarks in enumerate(chosen):
        assert len(landmarks) == LANDMARKS
        assert not (folds[landmarks] == one).any()  # no clip that is held out
    assert len(np.unique(np.concatenate(chosen))) < 1.5 * LANDMARKS


def test_all_clips_of_a_small_library_are_landmarks() -> None:
    training = np.array([4, 1, 7])
    np.testing.assert_array_equal(landmarks_among(training, 10), [1, 4, 7])
