from __future__ import annotations

import numpy as np
import pytest

from app.models.words.language.normalize import normalize_word, normalize_words
from app.models.words.vocabulary import WordVocabulary


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("Walk", "walk"),
        ("left leg", "left_leg"),
        ("High-Kick", "high_kick"),
        ("  a  -_ b ", "a_b"),
        ("ÉTÉ", "été"),
        ("--", ""),
    ],
)
def test_normalizing(word: str, expected: str) -> None:
    assert normalize_word(word) == expected


def test_words_come_once_in_their_order() -> None:
    assert normalize_words(["run", "Jog", "", "RUN"]) == ("run", "jog")


def test_label_matrix() -> None:
    labels = [["walk", "slow"], [], ["Walk"], ["unheard-of"]]
    vocabulary = WordVocabulary.of(labels[:3])
    assert vocabulary.words == ("slow", "walk")
    expected = [[1, 1], [0, 0], [0, 1], [0, 0]]
    np.testing.assert_array_equal(vocabulary.label_matrix(labels), expected)


def test_forms_of_a_word_are_one_word() -> None:
    labels = [["jumping", "walks"], ["jump"], ["waving"], ["bus"]]
    vocabulary = WordVocabulary.of(labels)
    assert vocabulary.words == ("bus", "jump", "walk", "wave")
    np.testing.assert_array_equal(vocabulary.label_matrix(labels).argmax(axis=1), [1, 1, 3, 0])


def test_a_word_is_found_in_any_form() -> None:
    vocabulary = WordVocabulary(("flinging_about", "jump"))
    assert vocabulary.find("jumps") == "jump"
    assert vocabulary.find("fling_about") == "flinging_about"
    assert vocabulary.find("sprint") is None


def test_weights_become_a_vector() -> None:
    vector = WordVocabulary(("jump", "run", "walk")).vector({"walk": 1.0, "run": 0.7})
    np.testing.assert_array_equal(vector, [0.0, 0.7, 1.0])


def test_an_empty_library_has_no_words() -> None:
    vocabulary = WordVocabulary.of([[], []])
    assert len(vocabulary) == 0
    assert vocabulary.label_matrix([[]]).shape == (1, 0)
