"""Runs an evaluation of any kind with its options, for a worker: the document that is kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from app.evaluate.keyposes.document import keypose_document
from app.evaluate.keyposes.evaluation import judge_keyposes
from app.evaluate.low_dimensional.document import low_dimensional_document
from app.evaluate.low_dimensional.evaluation import judge_low_dimensional
from app.evaluate.main_figures import main_figures
from app.evaluate.recognition.document import recognition_document
from app.evaluate.recognition.evaluation import judge_recognition
from app.evaluate.recognition.methods import METHODS
from app.evaluate.retrieval.document import retrieval_document
from app.evaluate.retrieval.evaluation import JUDGED, MAX_QUERIES, K, judge_retrieval
from app.evaluate.retrieval.volumes import judge_volumes
from app.evaluate.words.document import word_document
from app.evaluate.words.evaluation import judge_words, word_examples
from app.evaluate.words.symbols import judge_symbols
from app.models.keyposes.matching import TOLERANCE
from app.search.example.methods import Method
from app.services.evaluations.evaluations import Evaluated, bounded
from app.services.evaluations.options import EvaluationKind, EvaluationOptions
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.services.training.training_set import ready_only
from app.store.clips import labels, versions
from app.store.clips.filter import ClipFilter
from app.store.clips.listing import count_clips
from app.store.evaluations import NewEvaluation

Progress = Callable[[int, int], None]
Document = dict[str, Any]


def run_evaluation(
    lib: Library, kind: EvaluationKind, options: EvaluationOptions, progress: Progress
) -> Evaluated:
    """Judge the methods on the library as it is now.

    progress: called with the number of steps done and the total, by the kinds that take long.
    Raises BadField, NotEnoughLabels and NotEnoughKeyposes as the evaluation of this kind does, and
    TooLarge if its document is too large to be kept.
    """
    began = time.monotonic()
    filter = resolved_filter(lib, options.filter)
    with lib.store.read() as tx:
        version, persons = versions.version(tx), labels.person_names(tx)
        size = count_clips(tx, ready_only(filter))
    document = _RUNS[kind](lib, filter, options, progress)
    result = NewEvaluation(
        kind=kind.value,
        options=options.to_json(),
        library_version=version,
        library_size=size,
        seconds=round(time.monotonic() - began, 3),
        figures=main_figures(kind, document),
        document=bounded(document),
    )
    return Evaluated(result, frozenset(persons))


def _recognition(
    lib: Library, filter: ClipFilter, options: EvaluationOptions, progress: Progress
) -> Document:
    found = judge_recognition(
        lib,
        filter,
        options.methods or tuple(METHODS),
        false_accept_rate=options.false_accept_rate,
        by=options.by,
        progress=progress,
    )
    return recognition_document(found)


def _retrieval(
    lib: Library, filter: ClipFilter, options: EvaluationOptions, progress: Progress
) -> Document:
    threshold = options.eta or 0.0
    found = judge_retrieval(
        lib,
        filter,
        [Method(name) for name in options.methods] if options.methods else JUDGED,
        classes=options.classes,
        k=options.k or K,
        threshold=threshold,
        max_queries=options.max_queries or MAX_QUERIES,
        by=options.by,
        progress=progress,
    )
    volumes = judge_volumes(lib, filter, classes=options.classes, threshold=threshold)
    return retrieval_document(found, volumes)


def _words(lib: Library, filter: ClipFilter, options: EvaluationOptions, _: Progress) -> Document:
    # The examples come first: a word that no clip carries is said at once.
    examples = word_examples(lib, options.queries, filter)
    return word_document(judge_words(lib, filter), examples)


def _keyposes(
    lib: Library, filter: ClipFilter, options: EvaluationOptions, _: Progress
) -> Document:
    tolerance = options.tolerance or TOLERANCE
    return keypose_document(judge_keyposes(lib, filter, tolerance, options.by))


def _low_dimensional(
    lib: Library, filter: ClipFilter, _: EvaluationOptions, progress: Progress
) -> Document:
    return low_dimensional_document(judge_low_dimensional(lib, filter, progress))


def _symbols(lib: Library, filter: ClipFilter, _: EvaluationOptions, __: Progress) -> Document:
    return asdict(judge_symbols(lib, filter))


_RUNS: Mapping[
    EvaluationKind, Callable[[Library, ClipFilter, EvaluationOptions, Progress], Document]
] = {
    EvaluationKind.RECOGNITION: _recognition,
    EvaluationKind.RETRIEVAL: _retrieval,
    EvaluationKind.WORDS: _words,
    EvaluationKind.KEYPOSES: _keyposes,
    EvaluationKind.LOW_DIMENSIONAL: _low_dimensional,
    EvaluationKind.SYMBOLS: _symbols,
}
