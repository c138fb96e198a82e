from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.words.model import STATISTICS, WordModel, clip_cosines, fit_word_model
from app.models.words.vocabulary import WordVocabulary
from tests.models.word_clips import word_clips


def test_words_of_held_out_clips_are_predicted() -> None:
    _, statistics, words = word_clips(10)
    vocabulary = WordVocabulary.of(words)
    labels = vocabulary.label_matrix(words)
    model = fit_word_model(statistics[:28], labels[:28])
    predicted = model.predict(statistics[28:])
    assert ((predicted >= 0) & (predicted <= 1)).all()
    top = np.argsort(-predicted, axis=1)[:, :2]
    assert np.take_along_axis(labels[28:], top, axis=1).any(axis=1).mean() > 0.9
    wave = clip_cosines(predicted, vocabulary.vector({"wave": 1.0}))
    assert wave.argmax() % 4 == 2


def test_a_record_comes_back_from_its_arrays() -> None:
    _, statistics, words = word_clips(3)
    model = fit_word_model(statistics, WordVocabulary.of(words).label_matrix(words))
    arrays, meta = model.to_arrays()
    again = WordModel.from_arrays(arrays, meta)
    np.testing.assert_array_equal(again.predict(statistics), model.predict(statistics))
    with pytest.raises(ValueError, match="version 0"):
        WordModel.from_arrays(arrays, {**meta, "version": 0})


def test_signs_decide_for_a_clip_whose_statistics_are_strange() -> None:
    rng = np.random.default_rng(0)
    labels = np.eye(2)[np.arange(40) % 2]
    statistics = rng.normal(size=(40, STATISTICS))
    signs = labels[:, :1] * 4.0 + rng.normal(size=(40, 3)) * 0.1
    model = fit_word_model(np.hstack([statistics, signs]), labels)
    strange = np.hstack([np.full((1, STATISTICS), 9.0), np.full((1, 3), 4.0)])
    assert model.outputs(strange).argmax() == 0
    assert model.nearest(strange)[0] > 10.0 * model.nearest(np.hstack([statistics, signs])).max()
    again = WordModel.from_arrays(*model.to_arrays())
    np.testing.assert_array_equal(again.outputs(strange), model.outputs(strange))


@pytest.mark.parametrize("count", [1, 2, 4])
def test_few_clips_are_enough(count: int) -> None:
    _, statistics, words = word_clips(1)
    labels = WordVocabulary.of(words).label_matrix(words)
    model = fit_word_model(statistics[:count], labels[:count])
    assert np.isfinite(model.predict(statistics)).all()


def test_no_labels_are_refused() -> None:
    with pytest.raises(NotEnoughLabels):
        fit_word_model(np.zeros((0, 131)), np.zeros((0, 3)))
    with pytest.raises(NotEnoughLabels):
        fit_word_model(np.zeros((2, 131)), np.zeros((2, 0)))


def test_a_query_without_known_words_has_cosine_zero() -> None:
    assert not clip_cosines(np.ones((3, 2)), np.zeros(2)).any()
