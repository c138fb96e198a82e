"""Rows are computed once, in the order asked, and again only for clips that changed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.projections import Projections


class Model:
    """Gives each clip its number and a stamp; remembers which it was asked for."""

    def __init__(self, stamp: float = 0.0, gone: Sequence[str] = ()) -> None:
        self.stamp, self.gone, self.asked = stamp, gone, []

    def __call__(self, clip_ids: list[str]) -> dict[str, FloatArray]:
        self.asked.append(list(clip_ids))
        return {i: np.array([float(i), self.stamp]) for i in clip_ids if i not in self.gone}


def test_rows_are_computed_once_and_come_in_the_order_asked() -> None:
    rows, model = Projections(), Model(gone=["9"])
    assert rows.of("m", ["3", "1"], model)[1].tolist() == [[3, 0], [1, 0]]
    ids, found = rows.of("m", ["1", "9", "2", "3"], model)
    assert ids == ["1", "2", "3"]
    assert found.tolist() == [[1, 0], [2, 0], [3, 0]]
    assert model.asked == [["3", "1"], ["9", "2"]]
    assert rows.of("m", ["2", "3"], model, columns=[0])[1].tolist() == [[2], [3]]
    assert rows.of("m", ["4", "3"], model, columns=[0])[1].tolist() == [[4], [3]]


def test_no_clips_have_no_rows() -> None:
    assert Projections().of("m", [], Model())[0] == []
    ids, found = Projections().of("m", ["9"], Model(gone=["9"]), columns=[0])
    assert (ids, len(found)) == ([], 0)


def test_what_the_fit_knows_is_not_computed_but_for_changed_clips() -> None:
    rows, model = Projections(), Model(stamp=5.0)

    def known() -> tuple[list[str], FloatArray]:
        return ["1", "2"], np.array([[1.0, 7.0], [2.0, 7.0]])

    assert rows.of("m", ["2", "1"], model, known)[1].tolist() == [[2, 7], [1, 7]]
    rows.forget(["1"])
    assert rows.of("m", ["2", "1"], model, known)[1].tolist() == [[2, 7], [1, 5]]
    assert model.asked == [["1"]]


def test_another_model_has_rows_of_its_own() -> None:
    rows = Projections()
    rows.of("m", ["1"], Model())
    assert rows.of("n", ["1"], Model(stamp=2.0))[1].tolist() == [[1, 2]]


def test_a_change_during_the_computation_is_not_kept() -> None:
    rows, after = Projections(), Model(stamp=1.0)

    def meanwhile(clip_ids: list[str]) -> dict[str, FloatArray]:
        rows.forget(["1"])
        return Model()(clip_ids)

    assert rows.of("m", ["1"], meanwhile)[1].tolist() == [[1, 0]]
    assert rows.of("m", ["1"], after)[1].tolist() == [[1, 1]]


def test_rows_of_changed_clips_do_not_pile_up() -> None:
    rows = Projections()
    for change in range(3000):
        rows.of("m", ["1", "2"], Model(stamp=change))
        rows.forget(["1"])
    assert len(rows._rows) < 1100
    assert rows.of("m", ["2", "1"], Model(stamp=-1.0))[1].tolist() == [[2, 0], [1, -1]]
