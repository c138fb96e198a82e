"""Coordinates of the clips of an index against the obvious: all computed, compared one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from app.search.index import model_rows, rows
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.projected_index import ProjectedIndex
from app.search.index.vector_index import VECTOR, WIDTH, VectorIndex
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipFacts, ClipLabels, NewClip
from app.store.database import schema
from app.store.store import Store

K = 5
Add = Callable[..., str]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    url = f"sqlite:///{tmp_path / 'kinedex.sqlite3'}"
    schema.upgrade(url)
    opened = Store.open(url, tmp_path / "files")
    yield opened
    opened.close()


@pytest.fixture
def add(store: Store) -> Add:
    rng = np.random.default_rng(5)

    def ready(name: str, task: str | None = None) -> str:
        new = NewClip(f"{abs(hash(name)):064x}"[:64], f"{name}.bvh", 3, ClipLabels(name, task=task))
        facts = ClipFacts("bvh", 60, 30.0, 30.0, 2.0, 22, 0.01, {}, (), (), 1)
        with store.write() as tx:
            clip = clips.add_or_get(tx, new).clip
            vector = rng.normal(size=WIDTH).astype(np.float32)
            arrays.put_many(tx, clip.id, {VECTOR: vector}, version=1)
            clips.set_ready(tx, clip.id, facts)
        return clip.id

    return ready


class Model:
    """The first K numbers of a motion vector, turned; and what was asked of it."""

    def __init__(self, store: Store, name: str = "model", sign: float = 1.0) -> None:
        self.store, self.name, self.sign = store, name, sign
        self.asked: list[str] = []

    def project(self, clip_ids: Sequence[str]) -> Mapping[str, np.ndarray]:
        self.asked += clip_ids
        with self.store.read() as tx:
            found = arrays.get_many(tx, clip_ids, VECTOR)
        return {i: self.sign * vector[:K].astype(np.float64) for i, vector in found.items()}


def ask(
    projected: ProjectedIndex,
    model: Model,
    wanted: ClipFilter | None = None,
    exclude: frozenset[str] = frozenset(),
) -> NearestRanking:
    return projected.nearest(model.name, model.project, np.ones(K), wanted or ClipFilter(), exclude)


def test_distances_are_those_of_the_obvious_loop(store: Store, add: Add) -> None:
    ids = [add(f"c{i}") for i in range(30)]
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    found = ask(ProjectedIndex(index), model)
    obvious = {i: np.linalg.norm(p - 1) for i, p in model.project(ids).items()}
    assert list(found.ids) == sorted(ids, key=lambda i: obvious[i])
    np.testing.assert_allclose(found.distances, sorted(obvious.values()), rtol=1e-6)
    assert list(found.page(None, 7).ids) == list(found.ids[:7])


def test_only_what_is_new_is_computed(store: Store, add: Add) -> None:
    first, second = add("first", "walk"), add("second")
    index, model = VectorIndex(), Model(store)
    projected = ProjectedIndex(index)
    index.catch_up(store)
    ask(projected, model)
    ask(projected, model)
    assert sorted(model.asked) == sorted([first, second])
    with store.write() as tx:
        clips.patch(tx, first, {"task": "run"})
        clips.delete_clip(tx, second)
    third = add("third")
    index.catch_up(store)
    model.asked.clear()
    assert set(ask(projected, model).ids) == {first, third}
    assert sorted(model.asked) == sorted([first, third])
    assert list(ask(projected, model, ClipFilter(task=("run",))).ids) == [first]
    assert list(ask(projected, model, exclude=frozenset({first})).ids) == [third]


def test_another_model_has_coordinates_of_its_own(store: Store, add: Add) -> None:
    for i in range(5):
        add(f"c{i}")
    index = VectorIndex()
    index.catch_up(store)
    projected = ProjectedIndex(index)
    one, other = Model(store), Model(store, "other", sign=-1.0)
    order = list(ask(projected, one).ids)
    turned = ask(projected, other)
    assert list(turned.ids) != order
    assert len(other.asked) == 5
    assert list(ask(projected, one).ids) == order


def test_a_clip_that_goes_while_it_is_computed_disturbs_nothing(store: Store, add: Add) -> None:
    stays, goes = add("stays"), add("goes")
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    with store.write() as tx:
        clips.delete_clip(tx, goes)
    projected = ProjectedIndex(index)
    assert set(ask(projected, model).ids) == {stays, goes}
    index.catch_up(store)
    assert list(ask(projected, model).ids) == [stays]


def test_it_goes_on_when_the_index_drops_its_dead_rows(
    store: Store, add: Add, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rows, "MAX_FEW_DEAD", 2)
    monkeypatch.setattr(model_rows, "BATCH", 3)
    ids = [add(f"c{i}") for i in range(10)]
    index, model = VectorIndex(), Model(store)
    projected = ProjectedIndex(index)
    index.catch_up(store)
    ask(projected, model)
    for gone in ids[:7]:
        with store.write() as tx:
            clips.delete_clip(tx, gone)
    index.catch_up(store)
    late = add("late")
    index.catch_up(store)
    found = ask(projected, model)
    obvious = {i: np.linalg.norm(p - 1) for i, p in model.project([*ids[7:], late]).items()}
    assert list(found.ids) == sorted(obvious, key=lambda i: obvious[i])
    np.testing.assert_allclose(found.distances, sorted(obvious.values()), rtol=1e-6)


def test_what_a_fit_computed_is_taken_over_but_of_clips_that_changed_later(
    store: Store, add: Add
) -> None:
    first, second, third = add("first"), add("second"), add("third")
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    projected, fitted = ProjectedIndex(index), np.full((2, K), 9.0)

    def search() -> dict[str, float]:
        found = projected.nearest(
            "model",
            model.project,
            np.ones(K),
            ClipFilter(),
            fitted=lambda: ([first, second], fitted),
        )
        return dict(zip(found.ids, found.distances.tolist(), strict=True))

    there = search()
    assert model.asked == [third]
    assert there[first] == there[second] == pytest.approx(8 * np.sqrt(K))
    with store.write() as tx:
        clips.patch(tx, first, {"task": "run"})
    index.catch_up(store)
    after = search()
    assert model.asked == [third, first]
    assert after[first] != there[first]
    assert after[second] == there[second]


def test_an_empty_library_has_no_nearest(store: Store) -> None:
    index, model = VectorIndex(), Model(store)
    index.catch_up(store)
    found = ask(ProjectedIndex(index), model)
    assert len(found) == 0
    assert list(found.page(None, 10).ids) == []
