from __future__ import annotations

import numpy as np
import pytest

from app.models.word_vocabulary import WordVocabulary, normalise_word, normalise_words


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
def test_normalising(word: str, expected: str) -> None:
    assert normalise_word(word) == expected


def test_words_come_once_in_their_order() -> None:
    assert normalise_words(["run", "Jog", "", "RUN"]) == ("run", "jog")


def test_label_matrix() -> None:
    labels = [["walk", "slow"], [], ["Walk"], ["unheard-of"]]
    vocabulary = WordVocabulary.of(labels[:3])
    assert vocabulary.words == ("slow", "walk")
    expected = [[1, 1], [0, 0], [0, 1], [0, 0]]
    np.testing.assert_array_equal(vocabulary.label_matrix(labels), expected)


def test_a_query_tells_its_unknown_words() -> None:
    query = WordVocabulary(("left_leg", "walk")).query(["Left leg", "sprint", "sprint"])
    assert query.known == ("left_leg",)
    assert query.unknown == ("sprint",)
    np.testing.assert_array_equal(query.vector, [1.0, 0.0])


def test_an_empty_library_has_no_words() -> None:
    vocabulary = WordVocabulary.of([[], []])
    assert len(vocabulary) == 0
    assert vocabulary.label_matrix([[]]).shape == (1, 0)
