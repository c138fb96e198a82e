"""Query by example, judged on a library's own labels."""

from __future__ import annotations

import pytest

from app.errors import NotEnoughLabels
from app.search.methods import Method
from app.services import evaluate, find
from app.services.find import MotionQuery
from app.services.library import Library
from app.store.clip_filter import ClipFilter
from app.store.clip_record import ClipRecord


def test_retrieval_counts_what_searches_answer(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    told: list[tuple[int, int]] = []
    rows = evaluate.judge_retrieval(ready_library, progress=lambda *step: told.append(step))
    assert [row.method for row in rows] == [method.value for method in Method]
    assert told[-1] == (12 * len(Method), 12 * len(Method))
    for row in rows:
        hits = 0
        for clip in ready_clips:
            asked = MotionQuery(clip.id, method=row.method, limit=1)
            hits += find.find_motion(ready_library, asked).items[0].clip.task == clip.task
        assert row.nearest == pytest.approx(hits / 12)
        assert 0 <= row.precision_at_4 <= 0.5
        assert 0 < row.mean_average_precision <= 1


def test_a_filter_narrows_what_is_judged(ready_library: Library) -> None:
    two = ClipFilter(task=("walk", "kick"))
    (row,) = evaluate.judge_retrieval(ready_library, two, [Method.VECTOR])
    assert (row.queries, row.nearest, row.mean_average_precision) == (6, 1.0, 1.0)


def test_a_library_without_labels_cannot_be_judged(lib: Library) -> None:
    with pytest.raises(NotEnoughLabels):
        evaluate.judge_retrieval(lib)
