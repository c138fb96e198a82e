"""Who does what, in which words (DESIGN 8, "recognize")."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from app.errors import ModelNotFitted
from app.models.recognition.answers import NO_ANSWER, Answer, Recognition
from app.models.recognition.multilinear import recognize_multilinear
from app.models.recognition.perera import recognize_by_tensor
from app.models.recognition.recognizer import recognize as recognize_by_default
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.find.by_words import STATISTICS
from app.services.find.query import Question, describe
from app.services.library.library import Library
from app.store.files.files import Readable

SAMPLE = "motion_sample"
WIDE = "wide_motion_vector"
ANGLES = "angle_sample"
METHODS = ("default", "multilinear", "signatures", "perera")
"""The recogniser that does best held out; Vasilescu's model on positions and, as hers, on joint
angles; Perera's objective."""
LOOKED_AT = {"default": (SAMPLE, WIDE), "signatures": (ANGLES,)}
"""Arrays that a method is given, one behind the other; the others are given motion samples."""
WORDS_SHOWN = 10

WordScores = tuple[tuple[str, float], ...]
"""(word, score 0..1), the best first."""


@dataclass(frozen=True, slots=True)
class RecognizeQuery:
    """Exactly one of `clip_id` and `content`; method: one of METHODS.

    known_person, known_task: what is known already; skeleton, frame_rate (Hz), unit, roles,
    stack: of an upload only.
    """

    clip_id: str | None = None
    content: Readable | None = None
    known_person: str | None = None
    known_task: str | None = None
    method: str = "default"
    skeleton: Readable | None = None
    frame_rate: float | str | None = None
    unit: float | str | None = None
    roles: Mapping[str, str] | None = None
    stack: str | None = None


@dataclass(frozen=True, slots=True)
class Recognized:
    """Person, task, and words with their scores, the best first."""

    person: Answer
    task: Answer
    words: WordScores = field(default=())


def recognize(lib: Library, query: RecognizeQuery) -> Recognized:
    """Who does what in which words.

    Words are left out where no word model could be fitted. Raises BadField, ClipNotFound,
    ClipNotReady, ModelNotFitted, and BadContent for an upload that cannot be used.
    """
    if query.method not in METHODS:
        raise fields.bad_field("method", f"must be one of {', '.join(METHODS)}")
    if query.method != "default" and not lib.settings.recognize_persons:
        raise ModelNotFitted(
            f"The method {query.method} tells tasks by the persons who did them, and recognising"
            " people by how they move is switched off here: the default still tells the task."
        )
    question = Question(
        clip_id=query.clip_id,
        content=query.content,
        skeleton=query.skeleton,
        frame_rate=query.frame_rate,
        unit=query.unit,
        roles=query.roles,
        stack=query.stack,
    )
    looked_at = LOOKED_AT.get(query.method, (SAMPLE,))
    asked = describe(lib, question, (*looked_at, STATISTICS))
    sample = np.concatenate([asked.arrays[name] for name in looked_at])
    found = _who_does_what(lib, sample, query)
    return Recognized(found.person, found.task, words_of(lib, asked.arrays[STATISTICS]))


def _who_does_what(lib: Library, sample: FloatArray, query: RecognizeQuery) -> Recognition:
    """Person and task of a clip by what its method is given (LOOKED_AT)."""
    person = fields.text("known_person", query.known_person)
    task = fields.text("known_task", query.known_task)
    if query.method == "multilinear":
        model = lib.models.multilinear(lib.store).model
        found = recognize_multilinear(model, sample, person, task)
    elif query.method == "signatures":
        model = lib.models.signatures(lib.store).model
        found = recognize_multilinear(model, sample, person, task)
    elif query.method == "perera":
        tensor = lib.models.perera(lib.store).model
        (found,) = recognize_by_tensor(tensor, sample[None], person, task)
    else:
        found = recognize_by_default(lib.models.recognizer(lib.store).model, sample, person, task)
    if not lib.settings.recognize_persons:
        return replace(found, person=NO_ANSWER)
    return found


def words_of(lib: Library, statistics: FloatArray) -> WordScores:
    """The best words for a clip's `symbol_statistics` (131,); none without a word model."""
    try:
        model = lib.models.words(lib.store).model
    except ModelNotFitted:
        return ()
    scores = model.word_scores(statistics[None])[0]
    best = np.argsort(-scores, kind="stable")[:WORDS_SHOWN]
    return tuple((model.vocabulary.words[i], float(scores[i])) for i in best if scores[i] > 0)
