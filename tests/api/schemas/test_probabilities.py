"""Probabilities in answers have as many digits as their calibration justifies."""

from __future__ import annotations

import pytest
from pydantic import BaseModel, ValidationError

from app.api.schemas.base import Probability
from app.api.schemas.recognition import Answer
from app.models.recognition.answers import Answer as FoundAnswer
from app.models.recognition.answers import Candidate


class Shown(BaseModel):
    """An answer with one probability."""

    score: Probability


@pytest.mark.parametrize(
    ("score", "shown"), [(3e-13, 0.0), (1 - 3e-13, 1.0), (0.123456, 0.1235), (0.00006, 0.0001)]
)
def test_a_probability_is_rounded(score: float, shown: float) -> None:
    assert Shown(score=score).score == shown


@pytest.mark.parametrize("score", [-0.001, 1.001])
def test_a_number_that_is_no_probability_is_refused(score: float) -> None:
    with pytest.raises(ValidationError):
        Shown(score=score)


def test_the_candidates_of_an_answer_keep_their_order() -> None:
    candidates = tuple(Candidate(name, score) for name, score in [("a", 0.9), ("b", 3e-13)])
    answer = Answer.of(FoundAnswer("a", True, 0.9, candidates))
    assert [(one.label, one.score) for one in answer.candidates] == [("a", 0.9), ("b", 0.0)]
