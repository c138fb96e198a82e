"""Options of evaluations and their checks; documents stay small; persons are forgotten in them."""

from __future__ import annotations

import json
from dataclasses import fields, replace

import pytest

from app.demo import DemoClip
from app.errors import BadField, TooLarge
from app.evaluate import RECOGNIZERS as JUDGED_RECOGNIZERS
from app.services.clips import persons
from app.services.evaluations import evaluations
from app.services.evaluations.evaluations import TRIMMED, Evaluated, bounded
from app.services.evaluations.options import (
    OPTIONS,
    RECOGNIZERS,
    EvaluationKind,
    EvaluationOptions,
    check,
)
from app.services.library.library import Library
from app.store import evaluations as stored
from app.store.evaluations import NewEvaluation
from app.store.jobs import queue
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobState
from tests.libraries import upload

NEW = NewEvaluation("symbols", {}, 1, 12, 0.5, [{"name": "a", "value": 0.5, "unit": "share"}], {})


def test_the_recognizers_are_those_that_can_be_judged() -> None:
    assert tuple(JUDGED_RECOGNIZERS) == RECOGNIZERS


def test_every_option_belongs_to_a_kind() -> None:
    names = {one.name for one in fields(EvaluationOptions)}
    assert {name for some in OPTIONS.values() for name in some} == names
    assert set(OPTIONS) == set(EvaluationKind)


def test_options_are_read_as_they_were_written() -> None:
    options = EvaluationOptions(
        filter={"person": ["ada"]}, methods=("fused", "dtw"), k=4, classes=("walk",)
    )
    document = json.loads(json.dumps(options.to_json()))
    assert EvaluationOptions.from_json(document) == options
    assert EvaluationOptions.from_json({}) == EvaluationOptions()


def test_an_option_of_another_kind_is_named_with_those_of_this_kind() -> None:
    with pytest.raises(BadField) as refused:
        check(EvaluationKind.WORDS, EvaluationOptions(k=3))
    (place,) = refused.value.places
    assert place.location == "k"
    assert "its options are filter, queries" in place.message


def test_a_small_document_stays_as_it_is() -> None:
    document = {"confusion": {"shares": [[1.0]]}, "figures": [1.0]}
    assert bounded(document) == document


def test_a_large_document_loses_its_large_members_one_by_one() -> None:
    document = {
        "methods": {"a": {"confusion": [0.5] * 500, "curve": [0.5] * 10, "share": 0.5}},
        "rounds": [{"confusion": [0.5] * 500}],
    }
    small = bounded(document, 500)
    assert small == {
        "methods": {"a": {"curve": [0.5] * 10, "share": 0.5}},
        "rounds": [{}],
        TRIMMED: ["confusion"],
    }
    with pytest.raises(TooLarge, match="filter"):
        bounded({"figures": [0.5] * 500}, 500)


def _claimed(lib: Library) -> evaluations.ClaimedJob:
    evaluations.request(lib, EvaluationKind.SYMBOLS, EvaluationOptions())
    with lib.store.write() as tx:
        claimed = queue.take(tx, [JobKind.EVALUATE], "worker")
    assert claimed is not None
    return claimed


def test_the_end_of_a_job_names_the_kept_result(lib: Library) -> None:
    claimed = _claimed(lib)
    assert evaluations.requested(claimed) == (EvaluationKind.SYMBOLS, EvaluationOptions())
    with lib.store.write() as tx:
        evaluations.finish(tx, claimed, Evaluated(NEW, frozenset()))
        ended = jobs.get(tx, claimed.job.id)
    (kept,) = evaluations.list_evaluations(lib).items
    assert ended.state is JobState.SUCCEEDED
    assert ended.result == {"evaluation_id": kept.id, "kind": "symbols"}
    assert evaluations.get_evaluation(lib, kept.id) == (kept, {}, None)


def test_nothing_is_kept_if_a_person_was_forgotten_meanwhile(lib: Library) -> None:
    claimed = _claimed(lib)
    with lib.store.write() as tx:
        evaluations.finish(tx, claimed, Evaluated(NEW, frozenset({"ada"})))
        ended = jobs.get(tx, claimed.job.id)
    assert ended.state is JobState.FAILED
    assert ended.error is not None
    assert "start it again" in ended.error["detail"]
    assert evaluations.list_evaluations(lib).items == ()


def test_results_that_hold_a_text_are_removed(lib: Library) -> None:
    named = replace(NEW, document={"by_name": {"Zoë": 1.0}})
    filtered = replace(NEW, options={"filter": {"person": ["Zoë"]}})
    with lib.store.write() as tx:
        kept = stored.add(tx, NEW)
        for new in (named, filtered):
            stored.add(tx, new)
        assert stored.remove_where(tx, lambda text: "Zoë" in text) == 2
    assert evaluations.list_evaluations(lib).items == (kept,)


def test_a_forgotten_person_is_in_no_result_and_no_request(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    upload(lib, some_demo_clips[0], person="Zoë Quatermain")
    options = EvaluationOptions(filter={"person": "Zoë Quatermain"})
    job = evaluations.request(lib, EvaluationKind.SYMBOLS, options)
    named = replace(NEW, document={"by_name": {"Zoë Quatermain": 1.0}})
    with lib.store.write() as tx:
        kept = stored.add(tx, NEW)
        stored.add(tx, named)
    persons.forget_person(lib, "Zoë Quatermain")
    assert evaluations.list_evaluations(lib).items == (kept,)
    with lib.store.read() as tx:
        assert "Zoë" not in str(jobs.get_row(tx, job.id)["payload"])
