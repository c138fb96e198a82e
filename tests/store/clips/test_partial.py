"""Some fields of clips: the same values as those of whole clips."""

from __future__ import annotations

import pytest

from app.store.clips import partial, visibility
from app.store.clips import repository as clips
from app.store.clips.partial import FIELDS, PLAIN
from app.store.clips.record import AttachedAudio, ClipWarning
from app.store.store import Store
from tests.store.conftest import AddClip


def test_each_plain_field_is_that_of_the_whole_clip(store: Store, add_clip: AddClip) -> None:
    ids = [add_clip(name, ready=True, person="anna").id for name in ("a", "b")]
    with store.read() as tx:
        whole = clips.get_many(tx, ids)
        for name in PLAIN:
            some = partial.read(tx, [*ids, "nope"], [name])
            assert some.keys() == whole.keys()
            for clip_id in ids:
                assert getattr(some[clip_id], name) == getattr(whole[clip_id], name)


def test_a_field_that_was_not_read_is_missing(store: Store, add_clip: AddClip) -> None:
    clip_id = add_clip("a").id
    with store.read() as tx:
        found = partial.read(tx, [clip_id], ["name"])[clip_id]
    assert (found.id, found.name) == (clip_id, "a")
    with pytest.raises(AttributeError):
        _ = found.person


def test_every_field_is_that_of_the_whole_clip(store: Store, add_clip: AddClip) -> None:
    """Compared with the whole clips, which are read slowly."""
    made = [add_clip("a", ready=True, person="anna"), add_clip("b"), add_clip("c", ready=True)]
    ids = [clip.id for clip in made]
    changes = {
        "words": ("walk", "a"),
        "captions": ("Two.", "One."),
        "metadata": {"age": 3, "b": "x", "c": True},
        "audio": AttachedAudio("f" * 64),
        "audio_offset": 0.25,
        "path": "x/y.bvh",
    }
    with store.write() as tx:
        clips.patch(tx, ids[0], changes)
        clips.keep_analysis(tx, ids[2], ClipWarning("again", "It failed.", likely=2.0))
        clips.set_failed(tx, ids[1], {"code": "unreadable"})
    with store.read() as tx:
        whole, some = clips.get_many(tx, ids), partial.read(tx, ids, FIELDS)
        for clip_id in ids:
            for name in FIELDS:
                assert getattr(some[clip_id], name) == getattr(whole[clip_id], name), name


def test_clips_of_other_sources_are_not_read(store: Store, add_clip: AddClip) -> None:
    ids = [add_clip(name, ready=True, source=name).id for name in ("a", "b")]
    with store.read() as tx, visibility.only_source("a"):
        assert partial.read(tx, ids, ["name"]).keys() == {ids[0]}
