"""Recognizes the person and the task of a motion, and words that describe it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from app.errors import ModelNotFitted
from app.models.recognition.answers import NO_ANSWER, Answer, Recognition
from app.models.recognition.multilinear import recognize_multilinear
from app.models.recognition.perera import TensorRecognizer, recognize_by_tensor
from app.models.recognition.recognizer import Recognizer
from app.models.recognition.recognizer import recognize as recognize_by_default
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.find.by_words import word_arrays, word_scores
from app.services.find.queries import WORD_MODES
from app.services.find.query import Arrays, describe
from app.services.find.query_source import QuerySource
from app.services.library.library import Library

SAMPLE = "motion_sample"
WIDE = "wide_motion_vector"
ANGLES = "angle_sample"
METHODS = ("default", "multilinear", "signatures", "perera")
"""In this order: the recognizer that does best on held-out clips; Vasilescu's model on positions;
her model on joint angles, as she used it; Perera's objective."""
INPUTS = {"default": (SAMPLE, WIDE), "signatures": (ANGLES,)}
"""Arrays whose concatenation a method recognizes; the other methods recognize motion samples."""
CALIBRATED = ("default", "perera")
"""The methods whose scores are beliefs, calibrated on held-out clips. The scores of the others are
shares by nearness."""
WORDS_SHOWN = 10
UNJUDGED = (
    "No {0} could be held out when the model was fitted, since the library has too few. So nobody"
    " knows how often a new {0} is called known here, and the scores of the {0} are no beliefs."
)

WordScores = tuple[tuple[str, float], ...]
"""(word, score 0..1), the best first."""


@dataclass(frozen=True, slots=True)
class RecognizeQuery:
    """The motion to recognize.

    known_person, known_task: labels that the client already knows; the answer contains them;
    method: one of METHODS; word_mode: one of WORD_MODES, how words are predicted.
    """

    source: QuerySource
    known_person: str | None = None
    known_task: str | None = None
    method: str = "default"
    word_mode: str = "default"


@dataclass(frozen=True, slots=True)
class Recognized:
    """Person, task, and words with their scores, the best first.

    calibrated: whether the scores of persons and tasks are beliefs; else they are shares by
    nearness. warnings: what nobody could judge in this library, in words.
    """

    person: Answer
    task: Answer
    calibrated: bool
    warnings: tuple[str, ...]
    words: WordScores = field(default=())


def recognize(lib: Library, query: RecognizeQuery) -> Recognized:
    """The person, the task and the words of a motion.

    There are no words if no word model could be fitted. Raises BadField, ClipNotFound,
    ClipNotReady, ModelNotFitted, BadContent for an upload that cannot be used, and NotEnoughLabels
    if the word mode could not be fitted.
    """
    if query.word_mode not in WORD_MODES:
        raise fields.bad_field("word_mode", f"must be one of {', '.join(WORD_MODES)}")
    if query.method not in METHODS:
        raise fields.bad_field("method", f"must be one of {', '.join(METHODS)}")
    if query.method != "default" and not lib.settings.recognize_persons:
        raise ModelNotFitted(
            f"The method {query.method} recognizes tasks by the persons who did them, and"
            " recognizing people by how they move is switched off here. The default method still"
            " recognizes the task."
        )
    names = INPUTS.get(query.method, (SAMPLE,))
    arrays = describe(lib, query.source, (*names, *word_arrays(query.word_mode))).arrays
    sample = np.concatenate([arrays[name] for name in names])
    answers, unjudged = _person_and_task(lib, sample, query)
    words = words_of(lib, arrays, query.word_mode)
    calibrated = query.method in CALIBRATED and not unjudged
    warnings = tuple(UNJUDGED.format(factor) for factor in unjudged)
    return Recognized(answers.person, answers.task, calibrated, warnings, words)


def _person_and_task(
    lib: Library, sample: FloatArray, query: RecognizeQuery
) -> tuple[Recognition, list[str]]:
    """The recognized person and task, and which of both the model could not be judged on.

    sample: the concatenated INPUTS of the query's method.
    """
    unjudged: list[str] = []
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
        unjudged = _unjudged(tensor)
    else:
        recognizer = lib.models.recognizer(lib.store).model
        found = recognize_by_default(recognizer, sample, person, task)
        unjudged = _unjudged(recognizer)
    # A model that was fitted before the setting was switched off may be active for a moment.
    if not lib.settings.recognize_persons:
        return replace(found, person=NO_ANSWER), [each for each in unjudged if each != "person"]
    return found, unjudged


def _unjudged(model: Recognizer | TensorRecognizer) -> list[str]:
    """Which of "person" and "task" had too few labels to hold some out of the fit."""
    calibrations = {"person": model.person_calibration, "task": model.task_calibration}
    return [factor for factor, one in calibrations.items() if not one.is_judged]


def words_of(lib: Library, arrays: Arrays, mode: str) -> WordScores:
    """The best words for a motion with the `word_arrays` of a mode; empty without a word model."""
    try:
        model = lib.models.words(lib.store).model
    except ModelNotFitted:
        return ()
    scores = word_scores(model, arrays, mode)
    best = np.argsort(-scores, kind="stable")[:WORDS_SHOWN]
    return tuple((model.vocabulary.words[i], float(scores[i])) for i in best if scores[i] > 0)
