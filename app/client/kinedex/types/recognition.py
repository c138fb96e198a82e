"""Answers: recognition. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class Candidate(Record):
    """A possible label.

    score: Share of belief in this label, or share by nearness (see `calibrated`); all of them
    sum to at most 1. Rounded to 4 decimals, because the calibration is not more exact. 0 means
    very unlikely, not impossible.
    """

    label: str
    score: float


@dataclass(frozen=True, slots=True)
class Answer(Record):
    """The person or the task.

    label: Null if the library does not know the person or the task.
    score: Share of belief in `label`, or in the first candidate if `label` is null. Rounded to
    4 decimals, because the calibration is not more exact. 0 means very unlikely, not
    impossible.
    """

    label: str | None
    known: bool
    score: float
    candidates: list[Candidate]


@dataclass(frozen=True, slots=True)
class WordScore(Record):
    """A word that describes the motion.

    score: Probability that a clip with this motion carries the word. It is calibrated on held-
    out clips, so that scores of different clips and words can be compared. Rounded to 4
    decimals, because the calibration is not more exact. 0 means very unlikely, not impossible.
    """

    word: str
    score: float


@dataclass(frozen=True, slots=True)
class Recognition(Record):
    """Person, task and words of a motion.

    calibrated: Whether the scores of person and task are beliefs, calibrated on clips that were
    held out. If false, they are shares by nearness and say nothing about errors: so do
    `signatures` and `multilinear`, and all methods where `warnings` says so.
    warnings: What could not be judged when the model was fitted, because the library has too
    few persons or tasks to hold one out.
    """

    person: Answer
    task: Answer
    calibrated: bool
    warnings: list[str]
    words: list[WordScore]
