"""Annotations: one list for each clip; a new one counts as a change of the library."""

from __future__ import annotations

import pytest

from app.errors import ClipNotFound
from app.store.clips import keypose_annotations
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.store import Store
from tests.store.conftest import AddClip


def test_an_annotation_replaces_the_earlier_one_and_an_empty_one_removes_it(
    store: Store, add_clip: AddClip
) -> None:
    clip, other = add_clip("a", ready=True), add_clip("b")
    with store.write() as tx:
        keypose_annotations.put(tx, clip.id, [0.5, 1.0])
        keypose_annotations.put(tx, clip.id, [0.25, 1.5, 2.75])
        keypose_annotations.put(tx, other.id, [9.0])
    with store.read() as tx:
        assert keypose_annotations.get(tx, clip.id) == (0.25, 1.5, 2.75)
        assert keypose_annotations.get_many(tx, [other.id, "none", clip.id]) == {
            other.id: (9.0,),
            clip.id: (0.25, 1.5, 2.75),
        }
        assert keypose_annotations.annotated(tx) == tuple(sorted((clip.id, other.id)))
    with store.write() as tx:
        keypose_annotations.put(tx, clip.id, [])
    with store.read() as tx:
        assert keypose_annotations.get(tx, clip.id) is None
        assert keypose_annotations.annotated(tx) == (other.id,)


def test_deleting_a_clip_deletes_its_annotation(store: Store, add_clip: AddClip) -> None:
    clip = add_clip("a", ready=True)
    with store.write() as tx:
        keypose_annotations.put(tx, clip.id, [1.0])
        clips.delete_clip(tx, clip.id)
        assert keypose_annotations.annotated(tx) == ()


def test_an_annotation_of_a_ready_clip_raises_the_library_version(
    store: Store, add_clip: AddClip
) -> None:
    ready, queued = add_clip("a", ready=True), add_clip("b")
    with store.read() as tx:
        before = library.version(tx)
    with store.write() as tx:
        keypose_annotations.put(tx, queued.id, [1.0])
        assert library.changed_since(tx, before).changed == ()
        keypose_annotations.put(tx, ready.id, [1.0])
        assert library.changed_since(tx, before).changed == (ready.id,)


def test_an_unknown_clip_cannot_be_annotated(store: Store) -> None:
    with store.write() as tx, pytest.raises(ClipNotFound):
        keypose_annotations.put(tx, "clip_none", [1.0])
