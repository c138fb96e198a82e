"""The index against the obvious: a list of all clips, compared one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.search.array_cache import ArrayCache
from app.search.index import VECTOR, WIDTH, VectorIndex
from app.search.rows import Rows
from app.store import arrays, clips, schema
from app.store.clip_filter import ClipFilter
from app.store.clip_record import ClipFacts, ClipRecord, NewClip
from app.store.store import Store

Add = Callable[..., ClipRecord]


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

    def ready(name: str, duration: float = 2.0, **labels: Any) -> ClipRecord:
        new = NewClip(f"{abs(hash(name)):064x}"[:64], f"{name}.bvh", 3, name, **labels)
        facts = ClipFacts("bvh", 60, 30.0, 30.0, duration, 22, 0.01, {}, (), (), 1)
        vector = rng.normal(size=WIDTH).astype(np.float32)
        with store.write() as tx:
            clip = clips.add_or_get(tx, new).clip
            arrays.put_many(tx, clip.id, {VECTOR: vector}, version=1)
            clips.set_ready(tx, clip.id, facts)
            return clips.get(tx, clip.id)

    return ready


def _vector(store: Store, clip: ClipRecord) -> np.ndarray:
    with store.read() as tx:
        return arrays.get_one(tx, clip.id, VECTOR)


def test_distances_are_those_of_the_obvious_loop(store: Store, add: Add) -> None:
    all_clips = [add(f"c{i}") for i in range(30)]
    index = VectorIndex()
    index.catch_up(store)
    query = _vector(store, all_clips[3]).astype(np.float64) + 0.01
    found = index.nearest(query, ClipFilter())
    by_id = dict(zip(found.ids, found.distances, strict=True))
    for clip in all_clips:
        naive = np.linalg.norm(_vector(store, clip) - query)
        assert by_id[clip.id] == pytest.approx(naive, rel=1e-5)


def test_a_clip_is_at_no_distance_from_itself(store: Store, add: Add) -> None:
    clip = add("same")
    index = VectorIndex()
    index.catch_up(store)
    assert index.nearest(_vector(store, clip), ClipFilter()).distances.tolist() == [0.0]


def test_it_follows_the_library(store: Store, add: Add) -> None:
    index, kept, gone = VectorIndex(), add("kept", person="ada"), add("gone")
    first = index.catch_up(store)
    assert set(index.candidates(ClipFilter()).ids) == {kept.id, gone.id}
    with store.write() as tx:
        clips.delete_clip(tx, gone.id)
        clips.patch(tx, kept.id, {"person": "bruno"})
    late = add("late")
    assert index.catch_up(store) > first
    assert set(index.candidates(ClipFilter()).ids) == {kept.id, late.id}
    assert list(index.candidates(ClipFilter(person=("bruno",))).ids) == [kept.id]
    with store.write() as tx:
        clips.requeue(tx, late.id)
    index.catch_up(store)
    assert list(index.candidates(ClipFilter()).ids) == [kept.id]


FILTERS = [
    ClipFilter(),
    ClipFilter(person=("ada",)),
    ClipFilter(person=("ada", "bruno"), task=("walk",)),
    ClipFilter(person=("nobody",)),
    ClipFilter(word=("slow", "sad")),
    ClipFilter(license=("CC0",), min_duration=2.0),
    ClipFilter(min_duration=1.5, max_duration=2.5, source=("studio",)),
]


@pytest.mark.parametrize("wanted", FILTERS)
def test_filters_agree_with_those_of_lists(store: Store, add: Add, wanted: ClipFilter) -> None:
    from app.store.clip_listing import list_ids

    rng = np.random.default_rng(1)
    for i in range(40):
        add(
            f"clip {i}",
            duration=float(rng.choice([1.0, 2.0, 3.0])),
            person=str(rng.choice(["ada", "bruno", "chika"])),
            task=str(rng.choice(["walk", "run"])),
            words=tuple(rng.choice(["slow", "fast", "sad"], size=2, replace=False)),
            license=str(rng.choice(["CC0", "CC-BY"])),
            source=str(rng.choice(["studio", "field"])),
        )
    index = VectorIndex()
    index.catch_up(store)
    with store.read() as tx:
        expected = set(list_ids(tx, wanted))
    assert set(index.candidates(wanted).ids) == expected
    some = frozenset(list(expected)[:1])
    assert set(index.candidates(wanted, exclude=some).ids) == expected - some


def test_rows_survive_any_order_of_adding_and_removing() -> None:
    rng = np.random.default_rng(3)
    rows, kept = Rows(2), {}
    for step in range(3000):
        clip_id = f"c{rng.integers(1500)}"
        if rng.random() < 0.4:
            rows.remove(clip_id)
            kept.pop(clip_id, None)
        else:
            vector = np.array([step, -step], dtype=np.float32)
            rows.put(_record(clip_id), vector)
            kept[clip_id] = vector
    found = rows.passing(ClipFilter(), frozenset())
    assert {rows.ids[r]: rows.vectors[r].tolist() for r in found} == {
        clip_id: vector.tolist() for clip_id, vector in kept.items()
    }


def test_the_cache_stays_within_its_bytes_and_forgets_on_request(store: Store, add: Add) -> None:
    made = [add(f"c{i}") for i in range(10)]
    cache = ArrayCache(max_bytes=4 * WIDTH * 4)
    ids = [clip.id for clip in made]
    assert set(cache.get_many(store, ids, VECTOR)) == set(ids)
    assert cache.bytes_kept <= 4 * WIDTH * 4
    kept = cache.get_many(store, ids[-1:], VECTOR)[ids[-1]]
    assert cache.get_many(store, ids[-1:], VECTOR)[ids[-1]] is kept
    cache.forget(ids)
    assert cache.bytes_kept == 0
    assert cache.get_many(store, [*ids[-1:], "clip_gone"], VECTOR).keys() == {ids[-1]}


def _record(clip_id: str) -> Any:
    from types import SimpleNamespace

    return SimpleNamespace(
        id=clip_id, duration=1.0, words=(), person=None, task=None, license=None, source=None
    )
