"""The few figures of an evaluation that lists show, and by which two evaluations are compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Literal

from app.analysis.low_dimensional.eigen_motion import PAPER_DIMENSIONS
from app.models.held_out.word_methods import DEFAULT
from app.services.evaluations.options import EvaluationKind

Unit = Literal["share", "mm", "number"]
Figure = tuple[str, float | None, Unit]
"""A name, a value, and its unit: a share is 0..1."""


def main_figures(kind: EvaluationKind, document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The main figures of a document, the most important first; those without a value are left out.

    Two evaluations of the same kind have figures of the same names, as far as both judged them.
    """
    return [
        {"name": name, "value": float(value), "unit": unit}
        for name, value, unit in _FIGURES[kind](document)
        if value is not None
    ]


def _of_recognition(document: Mapping[str, Any]) -> Iterator[Figure]:
    take = document["left_out"].get("take", {"methods": {}})
    for method, judged in take["methods"].items():
        for factor in ("task", "person"):
            yield f"{factor}, {method}", judged["recognized"][factor]["share"], "share"


def _of_retrieval(document: Mapping[str, Any]) -> Iterator[Figure]:
    for row in document["figures"]:
        yield f"nearest clip, {row['method']}", row["nearest"], "share"
        yield f"MAP, {row['method']}", row["mean_average_precision"], "share"


def _of_words(document: Mapping[str, Any]) -> Iterator[Figure]:
    for row in sorted(document["figures"], key=lambda row: row["method"] != DEFAULT):
        yield f"one of 3 words, {row['method']}", row["top_3_recognition"], "share"
        yield f"word MAP, {row['method']}", row["word_map"], "share"


def _of_keyposes(document: Mapping[str, Any]) -> Iterator[Figure]:
    # With one recording nothing can be held out.
    way = "held_out" if document["recordings"] > 1 else "usual_thresholds"
    for method, judged in document["methods"].items():
        yield f"F, {method}", judged[way]["f"], "share"


def _of_low_dimensional(document: Mapping[str, Any]) -> Iterator[Figure]:
    for row in document["dimensions"]:
        if row["dimensions"] == PAPER_DIMENSIONS:
            for basis, error in row["error_mm"].items():
                yield f"error at {PAPER_DIMENSIONS} dimensions, {basis}", error, "mm"
    yield "clips whose keyposes cluster better", document["more_clustered"], "share"


def _of_symbols(document: Mapping[str, Any]) -> Iterator[Figure]:
    yield "error of distances to landmarks", document["placing_error"], "share"
    yield "error of distances among landmarks", document["fitting_error"], "share"
    yield "rank correlation with Monte Carlo", document["agreement"], "number"


_FIGURES: Mapping[EvaluationKind, Callable[[Mapping[str, Any]], Iterator[Figure]]] = {
    EvaluationKind.RECOGNITION: _of_recognition,
    EvaluationKind.RETRIEVAL: _of_retrieval,
    EvaluationKind.WORDS: _of_words,
    EvaluationKind.KEYPOSES: _of_keyposes,
    EvaluationKind.LOW_DIMENSIONAL: _of_low_dimensional,
    EvaluationKind.SYMBOLS: _of_symbols,
}
