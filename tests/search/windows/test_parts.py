"""An index of parts of clips against the store itself, while clips come, change and go."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from app.numerics.arrays import FloatArray
from app.search.index import rows as rows_module
from app.search.index.vector_index import VectorIndex
from app.search.windows.parts import NO_FILTER, Parts, parts_layout
from app.store.clips import arrays
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipFacts, ClipLabels, NewClip
from app.store.database import schema
from app.store.store import Store

VECTORS, SPANS, WIDTH = "part_vectors", "part_spans", 3
Add = Callable[[str, int], str]
Held = dict[str, list[tuple[float, float, list[float]]]]


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


def held(parts: Parts) -> Held:
    """What the parts that pass are, by clip id."""
    blocks = parts.view.blocks
    vectors = np.concatenate([block.vectors for block in blocks]) if blocks else np.zeros((0, 3))
    squares = np.concatenate([block.squares for block in blocks]) if blocks else np.zeros(0)
    found: Held = {}
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


def stored(store: Store, *clip_ids: str) -> Held:
    found: Held = {}
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


def view(index: VectorIndex, wanted: ClipFilter = NO_FILTER) -> Parts:
    return Parts.of(index.state[1], wanted)


def test_it_holds_every_part_of_every_clip_that_has_parts(
    store: Store, add: Add, index: VectorIndex
) -> None:
    ids = [add(f"clip {number}", number + 1) for number in range(5)]
    add("of an earlier analysis", 0)
    assert len(index) == 0
    version = index.catch_up(store)
    assert held(view(index)) == stored(store, *ids)
    assert index.catch_up(store) == version
    assert index.state[1].nbytes == 15 * (4 * WIDTH + 16) + 5 * 8


@pytest.mark.parametrize("gathered", [0, 1, 3, 1000])
def test_only_the_clips_that_are_meant_pass(
    store: Store, add: Add, index: VectorIndex, monkeypatch: pytest.MonkeyPatch, gathered: int
) -> None:
    """Whether whole blocks are multiplied, or only the rows of clips that pass."""
    monkeypatch.setattr(rows_module, "GATHER_RATIO", gathered)
    monkeypatch.setattr(rows_module, "BLOCK", 5)
    one, other, third = (add(name, parts) for name, parts in (("a", 4), ("b", 3), ("c", 5)))
    with store.write() as tx:
        clips.patch(tx, one, {"person": "ada"})
        clips.patch(tx, third, {"person": "ada", "words": ["slow"]})
    index.catch_up(store)
    assert held(view(index, ClipFilter(person=("ada",)))) == stored(store, one, third)
    assert held(view(index, ClipFilter(not_word=("slow",)))) == stored(store, one, other)
    assert held(view(index, ClipFilter(person=("nobody",)))) == {}
    queries = np.random.default_rng(5).normal(size=(2, WIDTH)).astype(np.float32)
    for wanted in (NO_FILTER, ClipFilter(person=("ada",)), ClipFilter(not_word=("slow",))):
        parts = view(index, wanted)
        own = np.array([vector for some in held(parts).values() for _, _, vector in some])
        apart = np.linalg.norm(queries[:, None] - own, axis=-1)
        assert parts.distances(queries) == pytest.approx(apart, rel=1e-5)
    with store.write() as tx:
        clips.patch(tx, one, {"person": None})
    index.catch_up(store)
    assert held(view(index, ClipFilter(person=("ada",)))) == stored(store, third)


def test_it_follows_the_library(store: Store, add: Add, index: VectorIndex) -> None:
    kept, changed, gone = (add(name, 3) for name in ("kept", "changed", "gone"))
    index.catch_up(store)
    before, seen = view(index), held(view(index))
    with store.write() as tx:
        clips.delete_clip(tx, gone)
    add("changed", 7)
    late, waiting, bad = add("late", 2), add("waiting", 2), add("bad", 2)
    with store.write() as tx:
        clips.requeue(tx, waiting)  # it stays there until it is analysed again
        clips.set_failed(tx, bad, {"code": "unreadable"})
    index.catch_up(store)
    assert held(view(index)) == stored(store, kept, changed, late, waiting)
    assert bad not in held(view(index))
    assert held(before) == seen


def test_rows_of_the_dead_are_given_back(
    store: Store, add: Add, index: VectorIndex, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rows_module, "MAX_FEW_DEAD", 0)
    for _ in range(20):
        again = add("again and again", 10)
        once = add("once", 10)
        index.catch_up(store)
        assert sum(map(len, index.state[1].blocks)) <= 20 / (1 - 0.25)
        assert held(view(index)) == stored(store, again, once)
