from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.words.library import LibraryWords, fit_library_words
from tests.models.word_clips import word_clips


@pytest.fixture(scope="module")
def clips():  # type: ignore[no-untyped-def]
    symbols, statistics, words = word_clips(6)
    words[0] = ()
    words[7] = ()
    return symbols, statistics, words


def test_both_modes_find_clips_for_a_word_and_words_for_a_clip(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols, statistics, words).words
    asked = model.ask(["waving"])
    points = model.space.place(symbols)
    default, cca = model.word_scores(statistics), model.word_scores_cca(points)
    surprises = model.clip_surprises(default, model.vocabulary.words, asked.items)
    angles = model.angle_scores(model.clip_angles(points, asked), asked)
    for scores in (np.exp(-surprises), angles):
        assert ((scores >= 0) & (scores <= 1)).all()
        assert scores.argmax() % 4 == 2
    for scores in (default, cca):
        best = np.argsort(-scores[0])[:3]  # a walk that carries no words
        assert {"walk", "stroll"} & {model.vocabulary.words[int(column)] for column in best}


def test_a_record_is_stored_and_read_back(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols, statistics, words).words
    arrays, meta = model.to_arrays()
    again = LibraryWords.from_arrays(arrays, json.loads(json.dumps(meta)))
    assert again.vocabulary == model.vocabulary
    np.testing.assert_array_equal(again.word_scores(statistics), model.word_scores(statistics))
    points = again.space.place(symbols)
    np.testing.assert_allclose(again.word_scores_cca(points), model.word_scores_cca(points))


def test_too_few_labelled_clips_leave_the_default_mode_alone(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, words = clips
    model = fit_library_words(symbols[:4], statistics[:4], [words[1], words[2], (), ()]).words
    assert model.word_scores(statistics).shape == (24, len(model.vocabulary))
    with pytest.raises(NotEnoughLabels):
        model.word_scores_cca(model.space.place(symbols))
    again = LibraryWords.from_arrays(*model.to_arrays())
    assert again.correlated is None


def test_no_words_at_all_are_refused(clips) -> None:  # type: ignore[no-untyped-def]
    symbols, statistics, _ = clips
    with pytest.raises(NotEnoughLabels):
        fit_library_words(symbols, statistics, [()] * len(symbols))
