"""The data for an index: labels and one array of each changed clip, in batches."""

from __future__ import annotations

import numpy as np
import pytest
from sqlalchemy import text, update

from app.store.clips import arrays, index_feed
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.index_feed import IndexedClip, changed_since
from app.store.database import tables
from app.store.store import Store
from tests.store.conftest import AddClip


def _changes(store: Store, since: int, array: str = "vector") -> list[IndexedClip]:
    with store.read() as tx:
        return [clip for batch in changed_since(tx, since, array) for clip in batch]


def test_a_clip_comes_with_its_labels_and_its_array(store: Store, add_clip: AddClip) -> None:
    labels = {"person": "ada", "task": "walk", "license": "CC0-1.0", "source": "studio"}
    clip = add_clip("walk", ready=True, words=("slow", "left_leg"), **labels)
    with store.write() as tx:
        arrays.put_many(tx, clip.id, {"vector": np.arange(3.0), "other": np.zeros(9)}, version=1)
    (indexed,) = _changes(store, 0)
    assert indexed.array is not None
    assert indexed.array.tolist() == [0.0, 1.0, 2.0]
    assert {name: getattr(indexed, name) for name in labels} == labels
    assert (indexed.id, indexed.is_ready, indexed.duration) == (clip.id, True, clip.duration)
    assert indexed.words == {"slow", "left_leg"}


def test_a_clip_without_labels_and_array(store: Store, add_clip: AddClip) -> None:
    add_clip("bare", ready=True)
    (indexed,) = _changes(store, 0)
    assert (indexed.person, indexed.words, indexed.array) == (None, frozenset(), None)


def test_only_clips_changed_since_a_version_in_the_order_of_their_changes(
    store: Store, add_clip: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(index_feed, "BATCH", 2)
    made = [add_clip(name, ready=True) for name in "abcde"]
    add_clip("never ready")
    with store.read() as tx:
        before = library.version(tx)
        sizes = [len(batch) for batch in changed_since(tx, 0, "vector")]
    assert sizes == [2, 2, 1]
    assert [clip.id for clip in _changes(store, 0)] == [clip.id for clip in made]
    with store.write() as tx:
        clips.patch(tx, made[3].id, {"task": "run"})
        clips.set_failed(tx, made[1].id, {"code": "unreadable"})
        clips.requeue(tx, made[2].id)  # it keeps its arrays until it is analyzed again
        clips.delete_clip(tx, made[0].id)
    assert [(c.id, c.is_ready) for c in _changes(store, before)] == [
        (made[3].id, True),
        (made[1].id, False),
    ]
    with store.read() as tx:
        assert library.deleted_since(tx, before) == (made[0].id,)
        assert library.deleted_since(tx, library.version(tx)) == ()


@pytest.mark.sqlite_only
def test_changed_clips_are_found_without_reading_all_clips(store: Store) -> None:
    """SQLite must use the index of the version; with that of the state it would read all clips."""
    with store.read() as tx:
        said = index_feed._CLIPS.params(since=1, array="vector")
        literal = said.compile(tx.engine, compile_kwargs={"literal_binds": True})
        steps = [row[3] for row in tx.execute(text(f"EXPLAIN QUERY PLAN {literal}"))]
    assert "ix_clips_changed_version" in steps[0]
    assert not any("SCAN" in step or "TEMP B-TREE" in step for step in steps)


def test_a_damaged_array_leaves_one_clip_out_of_the_index(store: Store, add_clip: AddClip) -> None:
    made = [add_clip(name, ready=True) for name in ("walk", "run")]
    with store.write() as tx:
        for clip in made:
            arrays.put_many(tx, clip.id, {"motion_vector": np.ones(8, np.float32)}, version=1)
        its = tables.clip_arrays.c.clip_id == made[0].id
        tx.execute(update(tables.clip_arrays).where(its).values(shape="9"))
    found = _changes(store, 0, "motion_vector")
    assert [clip.array is None for clip in found] == [True, False]
    with store.read() as tx:
        assert list(arrays.get_many(tx, [c.id for c in made], "motion_vector")) == [made[1].id]
