"""Query by example, judged with the labels of a library."""

from __future__ import annotations

import numpy as np
import pytest

from app import evaluate
from app.errors import BadField, NotEnoughLabels
from app.search.example.methods import Method
from app.services.find import find
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

SUN_METHODS = (Method.MSV_DTW, Method.MSV_XCORR)


def test_retrieval_judges_the_rankings_of_searches(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    methods = [Method.FUSED, Method.VECTOR, *SUN_METHODS]
    found = evaluate.judge_retrieval(ready_library, methods=methods)
    names = [judged.figures.method for judged in found.methods]
    assert names == [
        *methods,
        *("msv-dtw q=1", "msv-xcorr q=1", "rho alone", "msv-xcorr normalized"),
    ]
    for judged in found.methods[: len(methods)]:
        hits = 0
        for clip in ready_clips:
            asked = MotionQuery(QuerySource(clip.id), method=judged.figures.method, limit=1)
            hits += find.find_motion(ready_library, asked).items[0].clip.task == clip.task
        assert judged.figures.nearest == pytest.approx(hits / 12)
        assert 0 <= judged.figures.precision_at_4 <= 0.5
        assert judged.figures.precision_at_20 == pytest.approx(2 / 11)
        assert 0 < judged.figures.mean_average_precision <= 1


def test_progress_reaches_the_total(ready_library: Library) -> None:
    steps: list[tuple[int, int]] = []
    evaluate.judge_retrieval(
        ready_library,
        methods=[Method.VECTOR, Method.MSV_XCORR],
        threshold=0.3,
        progress=lambda *step: steps.append(step),
    )
    # 12 queries by two methods, by two rankings of the stored factors, and by one method with three
    # other settings of 12 volumes each
    assert steps == [(done, 120) for done in range(1, 121)]


def test_the_tables_of_the_paper(ready_library: Library) -> None:
    found = evaluate.judge_retrieval(
        ready_library, methods=[Method.VECTOR], classes=["kick", "walk"], k=2
    )
    (judged,) = found.methods
    assert (found.chosen, found.mixture, found.k) == (("kick", "walk"), 12, 2)
    assert (found.unlabeled, found.alone) == (0, 0)
    assert found.classes == ("bow", "kick", "walk", "wave")
    assert judged.confusion.shape == (4, 4)
    np.testing.assert_allclose(judged.confusion.sum(axis=1), 1.0)
    # three clips a class: two are relevant, so that both look at the same two
    np.testing.assert_allclose(judged.rates, np.diag(judged.confusion)[[1, 2]])
    assert judged.overall == pytest.approx(judged.rates.mean())
    assert judged.overall_confusion == pytest.approx(np.diag(judged.confusion).mean())
    assert found.sizes == (3, 3, 3, 3)


def test_with_a_threshold_above_all_distances_only_durations_are_compared(
    ready_library: Library,
) -> None:
    found = evaluate.judge_retrieval(ready_library, methods=SUN_METHODS, threshold=50.0)
    by_name = {judged.figures.method: judged for judged in found.methods}
    assert set(by_name) == {
        *SUN_METHODS, "rho alone", "msv-xcorr normalized", "msv-dtw q=1", "msv-xcorr q=1",
        "msv-dtw q=1 eta=50", "msv-xcorr q=1 eta=50",
        "msv-dtw q=2 eta=50", "msv-xcorr q=2 eta=50",
    }  # fmt: skip
    # matrices of ones, whatever q
    for method in SUN_METHODS:
        q1, q2 = (by_name[f"{method} q={q} eta=50"].figures for q in (1, 2))
        assert q1.mean_average_precision == pytest.approx(q2.mean_average_precision)


def test_the_number_of_queries_is_limited(ready_library: Library) -> None:
    found = evaluate.judge_retrieval(ready_library, methods=[Method.VECTOR], max_queries=8)
    assert found.methods[0].figures.queries == 8


def test_a_filter_selects_the_judged_clips(ready_library: Library) -> None:
    two = ClipFilter(task=("walk", "kick"))
    found = evaluate.judge_retrieval(ready_library, two, [Method.VECTOR])
    figures = found.methods[0].figures
    assert (figures.queries, figures.nearest) == (6, 1.0)
    assert figures.mean_average_precision > 0.9
    np.testing.assert_allclose(found.methods[0].confusion, np.eye(2), atol=0.2)


def test_a_library_without_labels_cannot_be_judged(lib: Library) -> None:
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_retrieval(lib)
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_volumes(lib)


def test_one_task_alone_cannot_be_judged(ready_library: Library) -> None:
    with pytest.raises(NotEnoughLabels, match="'walk', so every answer would be right"):
        evaluate.judge_retrieval(ready_library, ClipFilter(task=("walk",)))


@pytest.mark.parametrize(
    ("wrong", "place"),
    [
        ({"k": 0}, "k"),
        ({"threshold": -0.1}, "threshold"),
        ({"threshold": float("nan")}, "threshold"),
        ({"max_queries": 0}, "queries"),
        ({"classes": ["walk", "fly"]}, "classes"),
    ],
)
def test_wrong_numbers_and_names_are_refused(
    ready_library: Library, wrong: dict[str, object], place: str
) -> None:
    with pytest.raises(BadField) as refused:
        evaluate.judge_retrieval(ready_library, **wrong)  # type: ignore[arg-type]
    assert [p.location for p in refused.value.places] == [place]
