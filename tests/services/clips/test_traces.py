"""The name of a forgotten person is removed from captions too."""

from __future__ import annotations

from app.services.clips.traces import remove_name
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.record import ClipLabels, NewClip


def test_captions_that_name_the_person_vanish(lib: Library) -> None:
    captions = ("Zebulon walks", "a slow walk")
    labels = ClipLabels("walk", captions=captions)
    new = NewClip("a" * 64, "walk.bvh", 3, labels, sent=frozenset({"captions"}))
    with lib.store.write() as tx:
        clip_id = clips.add_or_get(tx, new).clip.id
        assert clips.get(tx, clip_id).captions == captions
        assert clips.get(tx, clip_id).imported == {"captions": list(captions)}
        remove_name(tx, "zebulon", ())
        left = clips.get(tx, clip_id)
        assert (left.captions, left.imported) == (("a slow walk",), {})
        clips.patch(tx, clip_id, {"captions": ("one", "two", "one")})
        assert clips.get(tx, clip_id).captions == ("one", "two")
        clips.delete_clip(tx, clip_id)
