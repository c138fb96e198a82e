"""Recognition of person, task and words."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from app.api.schemas.base import ROUNDED, Label, Outgoing, Probability
from app.api.schemas.labels import WORD_SCORE
from app.api.schemas.query_source import ClipId, QueryFields, QueryForm
from app.models.recognition.answers import Answer as FoundAnswer
from app.services.find.query_source import QuerySource
from app.services.recognition.recognize import Recognized, RecognizeQuery

_NEW = "If the library does not know it, it counts as new, and its label in the answer is null."


class _RecognitionOptions(QueryFields):
    method: Literal["default", "multilinear", "signatures", "perera"] = Field(
        "default",
        description="The recognizer. signatures: Vasilescu 2002, on joint angles. multilinear: the "
        "same on positions. perera: weighted distances of joints, Perera 2009.",
    )
    known_person: Label | None = Field(
        None, description=f"Recognize the task given the person. {_NEW}"
    )
    known_task: Label | None = Field(
        None, description=f"Recognize the person given the task. {_NEW}"
    )

    word_mode: Literal["default", "cca", "printed"] = Field(
        "default",
        description="How words are predicted: as in a search by words.",
    )

    def query(self, source: QuerySource) -> RecognizeQuery:
        """The recognition of a motion."""
        return RecognizeQuery(
            source=source,
            known_person=self.known_person,
            known_task=self.known_task,
            method=self.method,
            word_mode=self.word_mode,
        )


class Recognize(_RecognitionOptions):
    """Recognize a stored clip."""

    clip_id: ClipId

    model_config = ConfigDict(json_schema_extra={"examples": [{"clip_id": "CLIP_ID"}]})


class RecognizeForm(_RecognitionOptions, QueryForm):
    """Recognize an uploaded motion (never stored), or a stored clip."""


class Candidate(Outgoing):
    """A possible label."""

    label: str
    score: Probability = Field(
        description=f"Share of belief in this label, or share by nearness (see `calibrated`); all "
        f"of them sum to at most 1. {ROUNDED}"
    )


class Answer(Outgoing):
    """The person or the task."""

    label: str | None = Field(
        description="Null if the library does not know the person or the task."
    )
    known: bool
    score: Probability = Field(
        description="Share of belief in `label`, or in the first candidate if `label` is null. "
        f"{ROUNDED}"
    )
    candidates: list[Candidate]

    @classmethod
    def of(cls, answer: FoundAnswer) -> Answer:
        """An answer as the API shows it."""
        return cls(
            label=answer.label,
            known=answer.known,
            score=answer.score,
            candidates=[Candidate(label=c.label, score=c.score) for c in answer.candidates],
        )


class WordScore(Outgoing):
    """A word that describes the motion."""

    word: str
    score: Probability = Field(description=WORD_SCORE)


class Recognition(Outgoing):
    """Person, task and words of a motion."""

    person: Answer
    task: Answer
    calibrated: bool = Field(
        description="Whether the scores of person and task are beliefs, calibrated on clips that "
        "were held out. If false, they are shares by nearness and say nothing about errors: so do "
        "`signatures` and `multilinear`, and all methods where `warnings` says so."
    )
    warnings: list[str] = Field(
        description="What could not be judged when the model was fitted, because the library has "
        "too few persons or tasks to hold one out."
    )
    words: list[WordScore]

    @classmethod
    def of(cls, recognized: Recognized) -> Recognition:
        """A recognition as the API shows it."""
        return cls(
            person=Answer.of(recognized.person),
            task=Answer.of(recognized.task),
            calibrated=recognized.calibrated,
            warnings=list(recognized.warnings),
            words=[WordScore(word=word, score=score) for word, score in recognized.words],
        )
