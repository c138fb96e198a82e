from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.words.correlated_words import CCA, PRINTED, chosen_dimensions
from app.models.words.library import LibraryWords, fit_library_words
from app.models.words.symbol_space import possible_dimensions
from tests.models.word_clips import word_clips


@pytest.fixture(scope="module")
def clips():  # type: ignore[no-untyped-def]
    symbols, statistics, words = word_clips(6)
    words[0] = ()
    words[7] = ()
    return symbols, statistics, words


@pytest.mark.parametrize("mode", [CCA, PRINTED])
def test_all_modes_find_clips_for_a_word_and_words_for_a_clip(clips, mode: str) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols, statistics, words).words
    asked = model.ask(["waving"])
    points = model.space_of(mode).place(symbols)
    default, in_space = model.word_scores(statistics), model.word_scores_by(mode, points)
    surprises = model.clip_surprises(default, model.vocabulary.words, asked.items)
    distances = model.clip_distances(mode, points, asked)
    scores = model.distance_scores(mode, distances, asked)
    assert (np.diff(scores[np.argsort(distances)]) <= 0).all()
    for found in (np.exp(-surprises), scores):
        assert ((found >= 0) & (found <= 1)).all()
        assert found.argmax() % 4 == 2
    for found in (default, in_space):
        best = np.argsort(-found[0])[:3]  # a walk that carries no words
        assert {"walk", "stroll"} & {model.vocabulary.words[int(column)] for column in best}


def test_a_stretched_word_has_lower_scores_in_every_mode(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols, statistics, words).words
    exact, stretched = model.ask(["run"]), model.ask(["rush"])
    assert stretched.expanded == {"rush": ("run",)}
    for mode in (CCA, PRINTED):
        points = model.space_of(mode).place(symbols)
        scores = [
            model.distance_scores(mode, model.clip_distances(mode, points, asked), asked)
            for asked in (exact, stretched)
        ]
        assert (scores[1] < scores[0]).all()


def test_the_mode_cca_chooses_its_dimensions_by_held_out_words(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    fitted = fit_library_words(symbols, statistics, words)
    model = fitted.words
    assert set(model.losses) == {10}  # 24 symbols can place no more
    assert model.cca_space.points.shape[1] == fitted.cca_points.shape[1] == 10
    assert chosen_dimensions({10: 0.2, 20: 0.1, 40: 0.1}) == 20
    assert possible_dimensions((10, 20, 40), 498) == (10, 20, 40)


def test_a_record_is_stored_and_read_back(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols, statistics, words).words
    arrays, meta = model.to_arrays()
    again = LibraryWords.from_arrays(arrays, json.loads(json.dumps(meta)))
    assert again.vocabulary == model.vocabulary
    np.testing.assert_array_equal(again.word_scores(statistics), model.word_scores(statistics))
    assert again.losses == model.losses
    for mode in (CCA, PRINTED):
        points = again.space_of(mode).place(symbols)
        np.testing.assert_allclose(
            again.word_scores_by(mode, points), model.word_scores_by(mode, points)
        )


def test_too_few_labelled_clips_leave_the_default_mode_alone(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols[:4], statistics[:4], [words[1], words[2], (), ()]).words
    assert model.word_scores(statistics).shape == (24, len(model.vocabulary))
    with pytest.raises(NotEnoughLabels):
        model.word_scores_by(CCA, model.space.place(symbols))
    again = LibraryWords.from_arrays(*model.to_arrays())
    assert again.cca is None
    assert again.printed is None


def test_no_words_at_all_are_refused(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, _ = clips
    with pytest.raises(NotEnoughLabels):
        fit_library_words(symbols, statistics, [()] * len(symbols))
