"""The coordinates of the clips of an index, compared with a loop over all clips."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pytest

from app.search.index import model_rows, rows
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.projected_index import ProjectedIndex
from app.search.index.vector_index import VECTOR, VectorIndex
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.store import Store
from tests.search.stored_clips import AddClip

K = 5
Add = Callable[..., str]


@pytest.fixture
def add(add: AddClip) -> Add:
    """Store a ready clip, and return its id."""
    return lambda name, task=None: add(name, task=task).id


class Model:
    """A model with the first K numbers of a motion vector, times `sign`, as coordinates.

    It records the ids of the clips whose coordinates it computed.
    """

    def __init__(self, store: Store, name: str = "model", sign: float = 1.0) -> None:
        self.store, self.name, self.sign = store, name, sign
        self.computed: list[str] = []

    def project(self, clip_ids: Sequence[str]) -> Mapping[str, np.ndarray]:
        self.computed += clip_ids
        with self.store.read() as tx:
            found = arrays.get_many(tx, clip_ids, VECTOR)
        return {i: self.sign * vector[:K].astype(np.float64) for i, vector in found.items()}


def search(
    projected: ProjectedIndex,
    model: Model,
    clip_filter: ClipFilter | None = None,
    exclude: frozenset[str] = frozenset(),
) -> NearestRanking:
    return projected.nearest(
        model.name, model.project, np.ones(K), clip_filter or ClipFilter(), exclude
    )


def test_distances_are_those_of_a_loop(store: Store, add: Add) -> None:
    ids = [add(f"c{i}") for i in range(30)]
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    found = search(ProjectedIndex(index), model)
    obvious = {i: np.linalg.norm(p - 1) for i, p in model.project(ids).items()}
    assert list(found.ids) == sorted(ids, key=lambda i: obvious[i])
    np.testing.assert_allclose(found.distances, sorted(obvious.values()), rtol=1e-6)
    assert list(found.page(None, 7).ids) == list(found.ids[:7])


def test_only_new_clips_are_computed(store: Store, add: Add) -> None:
    first, second = add("first", "walk"), add("second")
    index, model = VectorIndex(), Model(store)
    projected = ProjectedIndex(index)
    index.catch_up(store)
    search(projected, model)
    search(projected, model)
    assert sorted(model.computed) == sorted([first, second])
    with store.write() as tx:
        clips.patch(tx, first, {"task": "run"})
        clips.delete_clip(tx, second)
    third = add("third")
    index.catch_up(store)
    model.computed.clear()
    assert set(search(projected, model).ids) == {first, third}
    assert sorted(model.computed) == sorted([first, third])
    assert list(search(projected, model, ClipFilter(task=("run",))).ids) == [first]
    assert list(search(projected, model, exclude=frozenset({first})).ids) == [third]


def test_another_model_has_its_own_coordinates(store: Store, add: Add) -> None:
    for i in range(5):
        add(f"c{i}")
    index = VectorIndex()
    index.catch_up(store)
    projected = ProjectedIndex(index)
    one, other = Model(store), Model(store, "other", sign=-1.0)
    order = list(search(projected, one).ids)
    turned = search(projected, other)
    assert list(turned.ids) != order
    assert len(other.computed) == 5
    assert list(search(projected, one).ids) == order


def test_a_clip_that_is_deleted_during_the_computation_is_no_problem(
    store: Store, add: Add
) -> None:
    stays, goes = add("stays"), add("goes")
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    with store.write() as tx:
        clips.delete_clip(tx, goes)
    projected = ProjectedIndex(index)
    assert set(search(projected, model).ids) == {stays, goes}
    index.catch_up(store)
    assert list(search(projected, model).ids) == [stays]


def test_coordinates_are_right_after_the_index_dropped_its_dead_rows(
    store: Store, add: Add, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rows, "MAX_FEW_DEAD", 2)
    monkeypatch.setattr(model_rows, "BATCH", 3)
    ids = [add(f"c{i}") for i in range(10)]
    index, model = VectorIndex(), Model(store)
    projected = ProjectedIndex(index)
    index.catch_up(store)
    search(projected, model)
    for gone in ids[:7]:
        with store.write() as tx:
            clips.delete_clip(tx, gone)
    index.catch_up(store)
    late = add("late")
    index.catch_up(store)
    found = search(projected, model)
    obvious = {i: np.linalg.norm(p - 1) for i, p in model.project([*ids[7:], late]).items()}
    assert list(found.ids) == sorted(obvious, key=lambda i: obvious[i])
    np.testing.assert_allclose(found.distances, sorted(obvious.values()), rtol=1e-6)


def test_coordinates_of_the_fit_are_used_except_of_clips_that_changed_later(
    store: Store, add: Add
) -> None:
    first, second, third = add("first"), add("second"), add("third")
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    projected, fitted = ProjectedIndex(index), np.full((2, K), 9.0)

    def distances() -> dict[str, float]:
        found = projected.nearest(
            "model",
            model.project,
            np.ones(K),
            ClipFilter(),
            fitted=lambda: ([first, second], fitted),
        )
        return dict(zip(found.ids, found.distances.tolist(), strict=True))

    before = distances()
    assert model.computed == [third]
    assert before[first] == before[second] == pytest.approx(8 * np.sqrt(K))
    with store.write() as tx:
        clips.patch(tx, first, {"task": "run"})
    index.catch_up(store)
    after = distances()
    assert model.computed == [third, first]
    assert after[first] != before[first]
    assert after[second] == before[second]


def test_an_empty_library_has_no_nearest(store: Store) -> None:
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    found = search(ProjectedIndex(index), model)
    assert len(found) == 0
    assert list(found.page(None, 10).ids) == []
