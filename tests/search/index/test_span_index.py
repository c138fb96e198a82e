"""The index over parts of clips against the store itself, while clips come, change and go."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from app.numerics.arrays import FloatArray
from app.search.index import span_index
from app.search.index.span_index import SpanIndex, Spans
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipFacts, ClipLabels, NewClip
from app.store.database import schema
from app.store.store import Store

VECTORS, SPANS, WIDTH = "part_vectors", "part_spans", 3
Add = Callable[[str, int], str]
Parts = dict[str, list[tuple[float, float, list[float]]]]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    url = f"sqlite:///{tmp_path / 'kinedex.sqlite3'}"
    schema.upgrade(url)
    opened = Store.open(url, tmp_path / "files")
    yield opened
    opened.close()


@pytest.fixture
def add(store: Store) -> Add:
    """Make a clip ready with so many parts (a clip of that name: analyse it again)."""
    rng = np.random.default_rng(3)

    def ready(name: str, parts: int) -> str:
        new = NewClip(name.encode().hex().zfill(64), f"{name}.bvh", 3, ClipLabels(name))
        facts = ClipFacts("bvh", 60, 30.0, 30.0, 9.0, 22, 0.01, {}, (), (), 1)
        starts = np.arange(parts, dtype=np.float32)
        found = {
            VECTORS: rng.normal(size=(parts, WIDTH)).astype(np.float16),
            SPANS: np.stack([starts, starts + 1.5], axis=1),
        }
        with store.write() as tx:
            clip = clips.add_or_get(tx, new).clip
            arrays.put_many(tx, clip.id, found if parts else {}, version=1)
            clips.set_ready(tx, clip.id, facts)
        return clip.id

    return ready


def told(view: Spans) -> Parts:
    """What a view holds of the clips that pass, by clip id."""
    found: Parts = {}
    for row in view.rows():
        vector: FloatArray = view.vectors[row]
        assert view.squares[row] == pytest.approx(float(vector @ vector))
        clip = view.owners[row]
        assert view.firsts[clip] <= row <= view.last_rows()[row]
        part = (float(view.starts[row]), float(view.ends[row]), vector.tolist())
        found.setdefault(str(view.ids[clip]), []).append(part)
    return found


def stored(store: Store, *clip_ids: str) -> Parts:
    found: Parts = {}
    with store.read() as tx:
        for clip_id in clip_ids:
            vectors, spans = (arrays.get_one(tx, clip_id, name) for name in (VECTORS, SPANS))
            found[clip_id] = [
                (float(start), float(end), vector.tolist())
                for (start, end), vector in zip(spans, vectors.astype(np.float32), strict=True)
            ]
    return found


@pytest.fixture
def index() -> SpanIndex:
    return SpanIndex(VECTORS, SPANS, WIDTH)


def test_it_holds_every_part_of_every_clip_that_has_parts(
    store: Store, add: Add, index: SpanIndex
) -> None:
    ids = [add(f"clip {number}", number + 1) for number in range(5)]
    add("of an earlier analysis", 0)
    assert len(index) == 0
    version = index.catch_up(store)
    assert told(index.view()) == stored(store, *ids)
    assert index.catch_up(store) == version
    assert index.bytes_kept == 15 * (4 * WIDTH + 16)


@pytest.mark.parametrize("few", [0, 1, 1000])
def test_only_the_clips_that_are_meant_pass(
    store: Store, add: Add, index: SpanIndex, monkeypatch: pytest.MonkeyPatch, few: int
) -> None:
    """Whether they are marked among all, or taken out because they are few."""
    monkeypatch.setattr(span_index, "FEW", few)
    one, other, third = (add(name, parts) for name, parts in (("a", 4), ("b", 3), ("c", 5)))
    with store.write() as tx:
        clips.patch(tx, one, {"person": "ada"})
        clips.patch(tx, third, {"person": "ada", "words": ["slow"]})
    index.catch_up(store)
    assert told(index.view(ClipFilter(person=("ada",)))) == stored(store, one, third)
    assert told(index.view(ClipFilter(not_word=("slow",)))) == stored(store, one, other)
    assert told(index.view(ClipFilter(person=("nobody",)))) == {}
    with store.write() as tx:
        clips.patch(tx, one, {"person": None})
    index.catch_up(store)
    assert told(index.view(ClipFilter(person=("ada",)))) == stored(store, third)


def test_it_follows_the_library(store: Store, add: Add, index: SpanIndex) -> None:
    kept, changed, gone = (add(name, 3) for name in ("kept", "changed", "gone"))
    index.catch_up(store)
    before, seen = index.view(), told(index.view())
    with store.write() as tx:
        clips.delete_clip(tx, gone)
    add("changed", 7)
    late, waiting, bad = add("late", 2), add("waiting", 2), add("bad", 2)
    with store.write() as tx:
        clips.requeue(tx, waiting)  # it stays there until it is analysed again
        clips.set_failed(tx, bad, {"code": "unreadable"})
    index.catch_up(store)
    assert told(index.view()) == stored(store, kept, changed, late, waiting)
    assert bad not in told(index.view())
    assert told(before) == seen


def test_rows_of_the_dead_are_given_back(store: Store, add: Add, index: SpanIndex) -> None:
    for _ in range(20):
        again = add("again and again", 10)
        once = add("once", 10)
        index.catch_up(store)
        assert len(index) <= 20 / (1 - 0.25)
        assert told(index.view()) == stored(store, again, once)
