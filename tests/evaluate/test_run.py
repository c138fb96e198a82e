"""Every kind of evaluation runs with its options, and gives a document with its main figures."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.errors import NotEnoughLabels
from app.evaluate.run import run_evaluation
from app.services.evaluations.options import EvaluationKind, EvaluationOptions
from app.services.library.library import Library
from app.store.evaluations import NewEvaluation


def _run(
    lib: Library, kind: EvaluationKind, **options: Any
) -> tuple[NewEvaluation, list[tuple[int, int]]]:
    steps: list[tuple[int, int]] = []
    found = run_evaluation(
        lib, kind, EvaluationOptions(**options), lambda *step: steps.append(step)
    )
    assert found.persons == {"ada", "bruno", "chika"}
    return found.result, steps


@pytest.mark.parametrize(
    ("kind", "options", "figure", "members"),
    [
        (
            EvaluationKind.RECOGNITION,
            {"methods": ("prior",)},
            "task, prior",
            {"left_out", "not_judged"},
        ),
        (
            EvaluationKind.RETRIEVAL,
            {"methods": ("vector",), "k": 2},
            "nearest clip, vector",
            {"figures", "confusion"},
        ),
        (EvaluationKind.WORDS, {}, "one of 3 words, default", {"by_word", "examples"}),
        (
            EvaluationKind.LOW_DIMENSIONAL,
            {},
            "error at 3 dimensions, keypose",
            {"dimensions", "poses"},
        ),
        (
            EvaluationKind.SYMBOLS,
            {},
            "error of distances to landmarks",
            {"errors", "agreement"},
        ),
    ],
)
def test_a_kind_gives_its_document_and_its_main_figures(
    ready_library: Library,
    kind: EvaluationKind,
    options: dict[str, Any],
    figure: str,
    members: set[str],
) -> None:
    result, steps = _run(ready_library, kind, **options)
    assert members <= set(result.document)
    json.dumps(result.document, allow_nan=False)
    assert figure in [one["name"] for one in result.figures]
    assert all(0 <= one["value"] <= 1 for one in result.figures if one["unit"] == "share")
    assert (result.kind, result.seconds >= 0) == (kind.value, True)
    assert all(done <= total for done, total in steps)


def test_long_kinds_tell_how_far_they_are(ready_library: Library) -> None:
    _, steps = _run(ready_library, EvaluationKind.RETRIEVAL, methods=("vector",))
    done = [one for one, _ in steps]
    assert done == list(range(1, steps[-1][1] + 1))


def test_a_filter_chooses_the_clips(ready_library: Library) -> None:
    result, _ = _run(ready_library, EvaluationKind.SYMBOLS)
    some, _ = _run(ready_library, EvaluationKind.SYMBOLS, filter={"not_task": "kick"})
    assert some.library_size == some.document["symbols"] < result.library_size


def test_a_library_without_annotated_keyposes_says_so(ready_library: Library) -> None:
    with pytest.raises(NotEnoughLabels, match="keyposes"):
        _run(ready_library, EvaluationKind.KEYPOSES)
