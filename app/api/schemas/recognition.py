"""Who is it, what do they do, in which words."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from app.api.schemas.base import Label, Outgoing
from app.api.schemas.labels import WORD_SCORE
from app.api.schemas.query_source import ClipId, QueryFields, QueryForm
from app.models.recognition.answers import Answer as FoundAnswer
from app.services.find.query_source import QuerySource
from app.services.recognition.recognise import Recognised, RecogniseQuery

_NEW = "One that the library does not know is taken to be new: its label in the answer is null."


class _Known(QueryFields):
    method: Literal["default", "multilinear", "signatures", "perera"] = Field(
        "default",
        description="The recogniser: signatures is Vasilescu 2002 on joint angles, multilinear the "
        "same on positions, perera the weighted distances of joints of Perera 2009.",
    )
    known_person: Label | None = Field(
        None, description=f"Recognise the task given the person. {_NEW}"
    )
    known_task: Label | None = Field(
        None, description=f"Recognise the person given the task. {_NEW}"
    )

    def query(self, source: QuerySource) -> RecogniseQuery:
        """The recognition of a motion."""
        return RecogniseQuery(
            source=source,
            known_person=self.known_person,
            known_task=self.known_task,
            method=self.method,
        )


class Recognize(_Known):
    """Recognise a stored clip."""

    clip_id: ClipId

    model_config = ConfigDict(json_schema_extra={"examples": [{"clip_id": "CLIP_ID"}]})


class RecognizeForm(_Known, QueryForm):
    """Recognise an uploaded motion (never stored), or a stored clip."""


class Candidate(Outgoing):
    """A label that it may be."""

    label: str
    score: float = Field(ge=0, le=1)


class Answer(Outgoing):
    """Who or what it is."""

    label: str | None = Field(description="Null when it is nobody or nothing known.")
    known: bool
    score: float = Field(ge=0, le=1)
    candidates: list[Candidate]

    @classmethod
    def of(cls, found: FoundAnswer) -> Answer:
        """An answer as it goes over the wire."""
        return cls(
            label=found.label,
            known=found.known,
            score=found.score,
            candidates=[Candidate(label=c.label, score=c.score) for c in found.candidates],
        )


class WordScore(Outgoing):
    """A word that describes the motion."""

    word: str
    score: float = Field(ge=0, le=1, description=WORD_SCORE)


class Recognition(Outgoing):
    """Person, task and words of a motion."""

    person: Answer
    task: Answer
    words: list[WordScore]

    @classmethod
    def of(cls, found: Recognised) -> Recognition:
        """A recognition as it goes over the wire."""
        return cls(
            person=Answer.of(found.person),
            task=Answer.of(found.task),
            words=[WordScore(word=word, score=score) for word, score in found.words],
        )
