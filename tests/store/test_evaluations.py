"""Kept results of evaluations: pages, the one before, documents apart, and removal."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.errors import EvaluationNotFound, PageNotFound
from app.store import evaluations
from app.store.evaluations import EvaluationRecord, NewEvaluation
from app.store.store import Store

NEW = NewEvaluation(
    kind="words",
    options={"filter": {"task": ["walk"]}},
    library_version=7,
    library_size=12,
    seconds=1.5,
    figures=[{"name": "MAP", "value": 0.5, "unit": "share"}],
    document={"figures": [1, 2], "examples": []},
)


def _add(store: Store, kind: str = "words") -> EvaluationRecord:
    with store.write() as tx:
        return evaluations.add(tx, replace(NEW, kind=kind))


def test_a_result_is_read_as_it_was_written(store: Store) -> None:
    added = _add(store)
    with store.read() as tx:
        assert evaluations.get(tx, added.id) == added
        assert evaluations.document(tx, added.id) == NEW.document
    assert (added.options, added.figures) == (NEW.options, NEW.figures)


def test_pages_are_newest_first_and_of_one_kind(store: Store) -> None:
    words = [_add(store) for _ in range(3)]
    _add(store, "symbols")
    with store.read() as tx:
        first = evaluations.list_page(tx, kind="words", limit=2)
        second = evaluations.list_page(tx, kind="words", limit=2, cursor=first.next)
        assert evaluations.total(tx, kind="words").count == 3
        assert len(evaluations.list_page(tx).items) == 4
    assert [*first.items, *second.items] == words[::-1]
    assert second.next is None


def test_a_bad_cursor_is_refused(store: Store) -> None:
    with store.read() as tx, pytest.raises(PageNotFound):
        evaluations.list_page(tx, cursor="nonsense")


def test_the_one_before_is_of_the_same_kind(store: Store) -> None:
    first, other, second = _add(store), _add(store, "symbols"), _add(store)
    with store.read() as tx:
        assert evaluations.before(tx, second) == first
        assert evaluations.before(tx, first) is None
        assert evaluations.before(tx, other) is None


def test_a_removed_result_is_gone(store: Store) -> None:
    added = _add(store)
    with store.write() as tx:
        evaluations.remove(tx, added.id)
        for read in (evaluations.get, evaluations.document, evaluations.remove):
            with pytest.raises(EvaluationNotFound, match=added.id):
                read(tx, added.id)
