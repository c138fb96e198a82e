"""An index of parts compared with the store, while clips are added, changed and deleted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from app.numerics.arrays import FloatArray
from app.search.index import rows as rows_module
from app.search.index.vector_index import VectorIndex
from app.search.windows.parts import NO_FILTER, Parts, parts_layout
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.store import Store
from tests.search.stored_clips import put_ready

VECTORS, SPANS, WIDTH = "part_vectors", "part_spans", 3
Add = Callable[[str, int], str]
PartsById = dict[str, list[tuple[float, float, list[float]]]]


@pytest.fixture
def add(store: Store) -> Add:
    """Store a ready clip with this number of parts, and return its id."""
    rng = np.random.default_rng(3)

    def ready(name: str, parts: int) -> str:
        starts = np.arange(parts, dtype=np.float32)
        own = {
            VECTORS: rng.normal(size=(parts, WIDTH)).astype(np.float16),
            SPANS: np.stack([starts, starts + 1.5], axis=1),
        }
        return put_ready(store, name, own if parts else {}, 9.0).id

    return ready


def parts_of(parts: Parts) -> PartsById:
    """Start, end and vector of the parts, by clip id."""
    blocks = parts.view.blocks
    vectors = np.concatenate([block.vectors for block in blocks]) if blocks else np.zeros((0, 3))
    squares = np.concatenate([block.squares for block in blocks]) if blocks else np.zeros(0)
    found: PartsById = {}
    lasts, seconds = parts.last_parts(), parts.seconds()
    for number, row in enumerate(parts.rows):
        vector: FloatArray = vectors[row]
        assert squares[row] == pytest.approx(float(vector @ vector))
        clip = parts.owners[number]
        assert parts.owners[lasts[number]] == clip
        assert seconds[clip] == parts.ends[lasts[number]]
        part = (float(parts.starts[number]), float(parts.ends[number]), vector.tolist())
        found.setdefault(str(parts.ids[clip]), []).append(part)
    return found


def stored(store: Store, *clip_ids: str) -> PartsById:
    found: PartsById = {}
    with store.read() as tx:
        for clip_id in clip_ids:
            vectors, spans = (arrays.get_one(tx, clip_id, name) for name in (VECTORS, SPANS))
            found[clip_id] = [
                (float(start), float(end), vector.tolist())
                for (start, end), vector in zip(spans, vectors.astype(np.float32), strict=True)
            ]
    return found


@pytest.fixture
def index() -> VectorIndex:
    return VectorIndex(layout=parts_layout(VECTORS, SPANS, WIDTH))


def view(index: VectorIndex, clip_filter: ClipFilter = NO_FILTER) -> Parts:
    return Parts.of(index.state[1], clip_filter)


def test_the_index_has_all_parts_of_all_clips(store: Store, add: Add, index: VectorIndex) -> None:
    ids = [add(f"clip {number}", number + 1) for number in range(5)]
    add("of an earlier analysis", 0)
    assert len(index) == 0
    version = index.catch_up(store)
    assert parts_of(view(index)) == stored(store, *ids)
    assert index.catch_up(store) == version
    assert index.state[1].nbytes == 15 * (4 * WIDTH + 16) + 5 * 8


@pytest.mark.parametrize("gathered", [0, 1, 3, 1000])
def test_a_filter_selects_the_parts_of_its_clips(
    store: Store, add: Add, index: VectorIndex, monkeypatch: pytest.MonkeyPatch, gathered: int
) -> None:
    """The result is the same if whole blocks or only the selected rows are multiplied."""
    monkeypatch.setattr(rows_module, "GATHER_RATIO", gathered)
    monkeypatch.setattr(rows_module, "BLOCK", 5)
    one, other, third = (add(name, parts) for name, parts in (("a", 4), ("b", 3), ("c", 5)))
    with store.write() as tx:
        clips.patch(tx, one, {"person": "ada"})
        clips.patch(tx, third, {"person": "ada", "words": ["slow"]})
    index.catch_up(store)
    assert parts_of(view(index, ClipFilter(person=("ada",)))) == stored(store, one, third)
    assert parts_of(view(index, ClipFilter(not_word=("slow",)))) == stored(store, one, other)
    assert parts_of(view(index, ClipFilter(person=("nobody",)))) == {}
    queries = np.random.default_rng(5).normal(size=(2, WIDTH)).astype(np.float32)
    for clip_filter in (NO_FILTER, ClipFilter(person=("ada",)), ClipFilter(not_word=("slow",))):
        parts = view(index, clip_filter)
        own = np.array([vector for some in parts_of(parts).values() for _, _, vector in some])
        apart = np.linalg.norm(queries[:, None] - own, axis=-1)
        assert parts.distances(queries) == pytest.approx(apart, rel=1e-5)
    with store.write() as tx:
        clips.patch(tx, one, {"person": None})
    index.catch_up(store)
    assert parts_of(view(index, ClipFilter(person=("ada",)))) == stored(store, third)


def test_the_index_follows_the_library(store: Store, add: Add, index: VectorIndex) -> None:
    kept, changed, gone = (add(name, 3) for name in ("kept", "changed", "gone"))
    index.catch_up(store)
    before, seen = view(index), parts_of(view(index))
    with store.write() as tx:
        clips.delete_clip(tx, gone)
    add("changed", 7)
    late, waiting, bad = add("late", 2), add("waiting", 2), add("bad", 2)
    with store.write() as tx:
        clips.requeue(tx, waiting)  # it stays there until it is analysed again
        clips.set_failed(tx, bad, {"code": "unreadable"})
    index.catch_up(store)
    assert parts_of(view(index)) == stored(store, kept, changed, late, waiting)
    assert bad not in parts_of(view(index))
    assert parts_of(before) == seen


def test_dead_rows_are_dropped(
    store: Store, add: Add, index: VectorIndex, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rows_module, "MAX_FEW_DEAD", 0)
    for _ in range(20):
        again = add("again and again", 10)
        once = add("once", 10)
        index.catch_up(store)
        assert sum(map(len, index.state[1].blocks)) <= 20 / (1 - 0.25)
        assert parts_of(view(index)) == stored(store, again, once)
