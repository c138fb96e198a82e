"""The results of recognition of a person and a task, shared by all recognizers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray

MAX_CANDIDATES = 10
"""The largest number of candidates in an answer."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A label and the share of belief in it, 0..1."""

    label: str
    score: float


@dataclass(frozen=True, slots=True)
class Answer:
    """The recognized person, or the recognized task, of a clip.

    label: None if it is unknown. known: whether the person (or task) is one of the library.
    score: belief in `label`, or in the best candidate if it is unknown; 0 without candidates.
    candidates: by falling score; the scores sum to at most 1. novelty: the distance of the clip
    beyond the threshold of the unknown; 0 or less for a known label, and 0 if the recognizer
    does not compute it.
    """

    label: str | None
    known: bool
    score: float
    candidates: tuple[Candidate, ...] = ()
    novelty: float = 0.0


@dataclass(frozen=True, slots=True)
class Recognition:
    """Both answers for one clip."""

    person: Answer
    task: Answer


NO_ANSWER = Answer(label=None, known=False, score=0.0)
"""The answer without candidates, such as the task in a library without task labels."""


def answer(labels: Sequence[str], scores: FloatArray, known: bool, novelty: float = 0.0) -> Answer:
    """The answer from the scores (labels,) of all labels, each 0..1, with a sum of at most 1."""
    if not labels:
        return NO_ANSWER
    order = np.argsort(-scores, kind="stable")[:MAX_CANDIDATES]
    best = tuple(Candidate(labels[i], float(scores[i])) for i in order)
    return Answer(best[0].label if known else None, known, best[0].score, best, novelty)


def given(label: str, labels: Sequence[str]) -> Answer:
    """The answer for a label that the caller gave: known if the library has that label."""
    if label not in labels:
        return NO_ANSWER
    return Answer(label, True, 1.0, (Candidate(label, 1.0),))
