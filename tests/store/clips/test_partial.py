"""Some fields of clips: the same values as those of whole clips."""

from __future__ import annotations

import pytest

from app.store.clips import partial
from app.store.clips import repository as clips
from app.store.clips.partial import PLAIN
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
