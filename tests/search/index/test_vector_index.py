"""The index compared with a loop over all clips."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.errors import StorageError
from app.search.index import nearest_ranking as near
from app.search.index.array_cache import ArrayCache
from app.search.index.vector_index import VECTOR, WIDTH, VectorIndex
from app.store.clips import arrays, index_feed
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.store import Store
from tests.search.stored_clips import AddClip


def _vector(store: Store, clip: ClipRecord) -> np.ndarray:
    with store.read() as tx:
        return arrays.get_one(tx, clip.id, VECTOR)


def test_distances_are_those_of_a_loop(store: Store, add: AddClip) -> None:
    all_clips = [add(f"c{i}") for i in range(30)]
    index = VectorIndex()
    index.catch_up(store)
    query = _vector(store, all_clips[3]).astype(np.float64) + 0.01
    found = index.nearest(query, ClipFilter())
    by_id = dict(zip(found.ids, found.distances, strict=True))
    for clip in all_clips:
        naive = np.linalg.norm(_vector(store, clip) - query)
        assert by_id[clip.id] == pytest.approx(naive, rel=1e-5)


def test_a_clip_has_distance_zero_to_itself(store: Store, add: AddClip) -> None:
    clip = add("same")
    index = VectorIndex()
    index.catch_up(store)
    assert index.nearest(_vector(store, clip), ClipFilter()).distances.tolist() == [0.0]


def test_it_follows_the_library(store: Store, add: AddClip) -> None:
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
    assert set(index.candidates(ClipFilter()).ids) == {kept.id, late.id}
    with store.write() as tx:
        clips.set_failed(tx, late.id, {"code": "unreadable"})
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
    ClipFilter(not_person=("ada",)),
    ClipFilter(not_task=("walk",), person=("ada", "bruno")),
    ClipFilter(not_person=("ada", "nobody"), not_source=("field",)),
    ClipFilter(not_word=("slow",)),
    ClipFilter(word=("fast",), not_word=("slow", "unheard"), not_license=("CC0",)),
    ClipFilter(task=("walk",), not_task=("walk",)),
]


@pytest.mark.parametrize("clip_filter", FILTERS)
def test_filters_select_the_same_clips_as_a_listing(
    store: Store, add: AddClip, clip_filter: ClipFilter
) -> None:
    from app.store.clips.listing import list_ids

    rng = np.random.default_rng(1)
    for i in range(40):
        add(
            f"clip {i}",
            duration=float(rng.choice([1.0, 2.0, 3.0])),
            person=rng.choice(np.array(["ada", "bruno", "chika", None], dtype=object)),
            task=rng.choice(np.array(["walk", "run", None], dtype=object)),
            words=tuple(rng.choice(["slow", "fast", "sad"], size=2, replace=False)),
            license=str(rng.choice(["CC0", "CC-BY"])),
            source=str(rng.choice(["studio", "field"])),
        )
    index = VectorIndex()
    index.catch_up(store)
    with store.read() as tx:
        expected = set(list_ids(tx, clip_filter))
    assert set(index.candidates(clip_filter).ids) == expected
    some = frozenset(list(expected)[:1])
    assert set(index.candidates(clip_filter, exclude=some).ids) == expected - some


def test_an_index_is_loaded_in_batches(
    store: Store, add: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(index_feed, "BATCH", 3)
    made = [add(f"c{i}", words=("slow",) if i % 2 else ("fast", "sad")) for i in range(8)]
    changed: list[str] = []
    index = VectorIndex(on_change=changed.extend)
    index.catch_up(store)
    assert sorted(changed) == sorted(index.candidates(ClipFilter()).ids)
    assert len(index) == len(made)
    labels = index.state[1].labels
    codes, sets = labels.word_sets()
    carried = dict(zip(labels.ids, [sets[code] for code in codes], strict=True))
    assert (carried[made[0].id], carried[made[1].id]) == ({"fast", "sad"}, {"slow"})
    assert set(index.candidates(ClipFilter(word=("slow",))).ids) == {c.id for c in made[1::2]}


def test_a_failed_load_is_repeated(
    store: Store, add: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(index_feed, "BATCH", 2)
    kept, gone, third = add("kept"), add("gone"), add("third")
    index = VectorIndex()
    whole = index_feed.changed_since

    def broken(*asked: Any) -> Iterator[Any]:
        yield next(whole(*asked))
        raise StorageError("the disk is gone")

    monkeypatch.setattr(index_feed, "changed_since", broken)
    with pytest.raises(StorageError):
        index.catch_up(store)
    assert not index.is_loaded
    with store.write() as tx:
        clips.delete_clip(tx, gone.id)
    monkeypatch.setattr(index_feed, "changed_since", whole)
    index.catch_up(store)
    assert set(index.candidates(ClipFilter()).ids) == {kept.id, third.id}


def test_searches_continue_while_changes_are_loaded(
    store: Store, add: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = add("first")
    index = VectorIndex()
    index.catch_up(store)
    late = add("late")
    loading, finish, whole = threading.Event(), threading.Event(), index_feed.changed_since

    def slow(*asked: Any) -> Iterator[Any]:
        loading.set()
        assert finish.wait(300)
        return whole(*asked)

    monkeypatch.setattr(index_feed, "changed_since", slow)
    thread = threading.Thread(target=index.catch_up, args=(store,))
    thread.start()
    assert loading.wait(300)
    assert list(index.nearest(np.zeros(WIDTH), ClipFilter()).ids) == [first.id]
    finish.set()
    thread.join(300)
    assert set(index.nearest(np.zeros(WIDTH), ClipFilter()).ids) == {first.id, late.id}


def test_many_threads_search_while_clips_are_added_and_deleted(store: Store, add: AddClip) -> None:
    """Each search sees a whole library: ready clips, in order, none twice, none half-changed."""
    stays = {add(f"stays {i}", person="ada", task="walk").id for i in range(20)}
    index = VectorIndex()
    stop, wrong = threading.Event(), []

    def search() -> None:
        while not stop.is_set():
            index.catch_up(store)
            found = index.nearest(np.zeros(WIDTH), ClipFilter(person=("ada",), task=("walk",)))
            page = found.page(None, 1000)
            if not stays <= set(page.ids) or len(set(page.ids)) != len(page.ids):
                wrong.append(list(page.ids))
            if len(page.ids) != len(found) or np.any(np.diff(page.distances) < 0):
                wrong.append(list(page.ids))

    threads = [threading.Thread(target=search) for _ in range(8)]
    for thread in threads:
        thread.start()
    for i in range(12):
        clip = add(f"comes {i}", person="bruno", task="walk")
        with store.write() as tx:
            clips.patch(tx, clip.id, {"person": "ada", "task": "run"})
        with store.write() as tx:
            clips.delete_clip(tx, clip.id)
    stop.set()
    for thread in threads:
        thread.join(300)
    assert not wrong


def test_no_search_waits_for_another(
    store: Store, add: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eight searches are in the middle of their product at the same moment."""
    add("one")
    index = VectorIndex()
    index.catch_up(store)
    all_inside, whole = threading.Barrier(8), near.nearest

    def wait_for_all(*asked: Any) -> Any:
        all_inside.wait(300)
        return whole(*asked)

    monkeypatch.setattr(near, "nearest", wait_for_all)

    def search(_: int) -> int:
        index.catch_up(store)
        return len(index.nearest(np.zeros(WIDTH), ClipFilter()).page(None, 1).ids)

    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(search, range(8))) == [1] * 8


OTHER_PROCESS = """
import sys
from pathlib import Path
from app.store.clips import repository as clips
from app.store.store import Store

store = Store.open(sys.argv[1], Path(sys.argv[2]))
for clip_id in sys.argv[3:]:
    with store.write() as tx:
        if clip_id.startswith("-"):
            clips.delete_clip(tx, clip_id[1:])
        else:
            clips.patch(tx, clip_id, {"task": "found"})
    print("committed", flush=True)
    sys.stdin.readline()
"""


def test_the_index_follows_another_process(store: Store, add: AddClip, tmp_path: Path) -> None:
    changed, gone = add("changed"), add("gone")
    index = VectorIndex()
    index.catch_up(store)
    command = [sys.executable, "-c", OTHER_PROCESS, str(store.database.engine.url)]
    other = subprocess.Popen(
        [*command, str(tmp_path / "files"), changed.id, f"-{gone.id}"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert other.stdin is not None
    assert other.stdout is not None
    try:
        for left in (2, 1):
            assert other.stdout.readline() == "committed\n"
            index.catch_up(store)
            assert list(index.candidates(ClipFilter(task=("found",))).ids) == [changed.id]
            assert len(index) == left
            other.stdin.write("\n")
            other.stdin.flush()
    finally:
        other.kill()
        other.communicate()


def test_the_cache_stays_within_its_bytes_and_forgets_on_request(
    store: Store, add: AddClip
) -> None:
    made = [add(f"c{i}") for i in range(10)]
    cache = ArrayCache(max_bytes=4 * WIDTH * 4)
    ids = [clip.id for clip in made]
    assert set(cache.get_many(store, ids, VECTOR)) == set(ids)
    assert cache.cached_bytes <= 4 * WIDTH * 4
    kept = cache.get_many(store, ids[-1:], VECTOR)[ids[-1]]
    assert cache.get_many(store, ids[-1:], VECTOR)[ids[-1]] is kept
    cache.forget(ids)
    assert cache.cached_bytes == 0
    assert cache.get_many(store, [*ids[-1:], "clip_gone"], VECTOR).keys() == {ids[-1]}
