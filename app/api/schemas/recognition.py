"""Who is it, what do they do, in which words."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from app.api.schemas.base import Incoming, Label, Outgoing
from app.api.schemas.labels import WORD_SCORE
from app.api.schemas.search import ClipId, UploadFields
from app.models.recognition.answers import Answer as FoundAnswer
from app.services.recognition.recognize import Recognized

_NEW = "One that the library does not know is taken to be new: its label in the answer is null."


class _Known(Incoming):
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


class Recognize(_Known):
    """Recognise a stored clip."""

    clip_id: ClipId

    model_config = ConfigDict(json_schema_extra={"examples": [{"clip_id": "CLIP_ID"}]})


class RecognizeForm(_Known, UploadFields):
    """Recognise an uploaded motion (never stored), or a stored clip."""

    clip_id: ClipId | None = None


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
    def of(cls, found: Recognized) -> Recognition:
        """A recognition as it goes over the wire."""
        return cls(
            person=Answer.of(found.person),
            task=Answer.of(found.task),
            words=[WordScore(word=word, score=score) for word, score in found.words],
        )
