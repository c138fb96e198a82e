"""Rows of a model are computed once, in its order, and again only for clips that changed."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from app.errors import ClientLeft
from app.numerics.arrays import FloatArray
from app.search.index import model_rows as module
from app.search.index.labels import Labels
from app.search.index.model_rows import ModelRows
from tests.search.indexed import indexed


class Model:
    """Gives each clip its number and a stamp; remembers which it was asked for."""

    def __init__(self, stamp: float = 0.0, gone: Sequence[str] = ()) -> None:
        self.stamp, self.gone = stamp, gone
        self.asked: list[list[str]] = []

    def __call__(self, clip_ids: Sequence[str]) -> Mapping[str, FloatArray]:
        self.asked.append(list(clip_ids))
        return {i: np.array([float(i), self.stamp]) for i in clip_ids if i not in self.gone}


def labels_of(*clip_ids: str) -> Labels:
    made = Labels()
    put(made, *clip_ids)
    return made


def put(labels: Labels, *clip_ids: str) -> None:
    """As an index does with clips that came or changed."""
    labels.remove(clip_ids)
    labels.add([indexed(clip_id) for clip_id in clip_ids])


def test_rows_are_in_the_order_of_the_index() -> None:
    labels, model, rows = labels_of("3", "1"), Model(), ModelRows()
    found = rows.of(labels.view(), "m", 2, model)
    assert found.values.tolist() == [[3, 0], [1, 0]]
    put(labels, "2")
    later = rows.of(labels.view(), "m", 2, model)
    assert later.values.tolist() == [[3, 0], [1, 0], [2, 0]]
    assert later.series is found.series
    assert model.asked == [["3", "1"], ["2"]]


def test_the_next_request_continues_after_a_request_that_stopped(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "BATCH", 2)
    labels, rows, model = labels_of(*"123456"), ModelRows(), Model(stamp=7.0)
    known = np.array([[9.0, 9.0], [9.0, 9.0]])

    def stops(clip_ids: Sequence[str]) -> Mapping[str, FloatArray]:
        if "4" in clip_ids:
            raise ClientLeft
        return model(clip_ids)

    with pytest.raises(ClientLeft):
        rows.of(labels.view(), "m", 2, stops, lambda: (["3", "5"], known))
    put(labels, "5")  # what was known of it holds no more
    found = rows.of(labels.view(), "m", 2, model)
    by_id = dict(zip(labels.view().ids.tolist(), found.values.tolist(), strict=True))
    assert by_id == {
        "1": [1, 7], "2": [2, 7], "3": [9, 9], "4": [4, 7], "6": [6, 7], "5": [5, 7]
    }  # fmt: skip
    assert model.asked == [["1", "2"], ["4"], ["6"], ["5"]]


def test_a_clip_without_arrays_has_no_row() -> None:
    labels, model, rows = labels_of("3", "9", "1"), Model(gone=["9"]), ModelRows()
    for _ in range(2):
        assert rows.of(labels.view(), "m", 2, model).has_row.tolist() == [True, False, True]
    assert len(model.asked) == 1


def test_an_empty_index_has_no_rows() -> None:
    found = ModelRows().of(Labels().view(), "m", 2, Model())
    assert found.values.shape == (0, 2)
    assert found.has_row.shape == (0,)


def test_a_changed_clip_is_computed_again_and_an_older_view_stays_the_same() -> None:
    labels, rows = labels_of("1", "2"), ModelRows()
    before = labels.view()
    rows.of(before, "m", 2, Model())
    put(labels, "1")
    after = Model(stamp=5.0)
    found = rows.of(labels.view(), "m", 2, after)
    assert found.values[found.has_row].tolist() == [[1, 0], [2, 0], [1, 5]]
    assert labels.view().alive.tolist() == [False, True, True]
    assert after.asked == [["1"]]
    assert rows.of(before, "m", 2, after).values.tolist() == [[1, 0], [2, 0]]


def test_rows_of_the_fit_are_not_computed_again() -> None:
    labels, model, rows = labels_of("1", "2", "3"), Model(), ModelRows()

    def known() -> tuple[list[str], FloatArray]:
        return ["2", "4"], np.array([[2.0, 7.0], [4.0, 7.0]])

    found = rows.of(labels.view(), "m", 2, model, known)
    assert found.values.tolist() == [[1, 0], [2, 7], [3, 0]]
    assert model.asked == [["1", "3"]]


def test_another_model_has_its_own_rows_and_width() -> None:
    labels, rows = labels_of("1"), ModelRows()
    one = rows.of(labels.view(), "m", 2, Model())
    other = rows.of(labels.view(), "n", 3, lambda ids: {i: np.full(3, 2.0) for i in ids})
    assert other.values.tolist() == [[2, 2, 2]]
    assert other.series is not one.series
    assert one.values.tolist() == [[1, 0]]


def test_many_clips_are_computed_in_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "BATCH", 3)
    labels, model = labels_of(*map(str, range(8))), Model()
    found = ModelRows().of(labels.view(), "m", 2, model)
    assert [len(asked) for asked in model.asked] == [3, 3, 2]
    assert found.values[:, 0].tolist() == list(range(8))


def test_a_failed_computation_is_repeated() -> None:
    labels, rows = labels_of("1"), ModelRows()

    def fails(clip_ids: Sequence[str]) -> Mapping[str, FloatArray]:
        raise OSError

    with pytest.raises(OSError):
        rows.of(labels.view(), "m", 2, fails)
    assert rows.of(labels.view(), "m", 2, Model()).values.tolist() == [[1, 0]]


def test_a_search_does_not_wait_while_rows_of_new_clips_are_computed() -> None:
    labels, rows = labels_of("1", "2"), ModelRows()
    before = labels.view()
    rows.of(before, "m", 2, Model())
    put(labels, "3")
    computing, finish = threading.Event(), threading.Event()

    def slow(clip_ids: Sequence[str]) -> Mapping[str, FloatArray]:
        computing.set()
        assert finish.wait(300)
        return Model()(clip_ids)

    computer = threading.Thread(target=rows.of, args=(labels.view(), "m", 2, slow))
    computer.start()
    assert computing.wait(300)
    found: list[FloatArray] = []
    search = threading.Thread(target=lambda: found.append(rows.of(before, "m", 2, Model()).values))
    search.start()
    search.join(300)
    finish.set()
    computer.join(300)
    assert [values.tolist() for values in found] == [[[1, 0], [2, 0]]]
    assert rows.of(labels.view(), "m", 2, Model()).values.tolist() == [[1, 0], [2, 0], [3, 0]]
