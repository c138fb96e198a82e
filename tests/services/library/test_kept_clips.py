"""Texts of clips are used again only while they are right, and only for those who may see them."""

from __future__ import annotations

from sqlalchemy import update

from app.services.library import kept_clips
from app.services.library.kept_clips import OVERHEAD, KeptClips
from app.store.clips import repository as clips
from app.store.clips import visibility
from app.store.clips.partial import PLAIN
from app.store.clips.record import ClipWarning
from app.store.database import tables as t
from app.store.store import Store
from tests.store.conftest import AddClip, add_clip, database_url, empty_database, store

__all__ = ["add_clip", "database_url", "empty_database", "store"]

NAMES = frozenset({"name", "words"})


def _read(store: Store, kept: KeptClips, *ids: str) -> dict[str, bytes | None]:
    """The kept texts; a clip without one is written as its words."""
    with store.read() as tx:
        found = kept.read(tx, ids, NAMES)
    texts = {clip_id: clip.text for clip_id, clip in found.items()}
    for clip in found.values():
        if clip.text is None and clip.keep is not None:
            clip.keep(" ".join(clip.words).encode())
    return texts


def test_a_text_is_kept_until_the_clip_changes(store: Store, add_clip: AddClip) -> None:
    kept, clip_id = KeptClips(), add_clip("a", ready=True).id
    assert _read(store, kept, clip_id) == {clip_id: None}
    assert _read(store, kept, clip_id) == {clip_id: b""}
    with store.write() as tx:
        clips.patch(tx, clip_id, {"words": ("walk",)})
    assert _read(store, kept, clip_id) == {clip_id: None}
    assert _read(store, kept, clip_id) == {clip_id: b"walk"}


def test_changes_without_a_new_version_count_too(store: Store, add_clip: AddClip) -> None:
    kept, clip_id = KeptClips(), add_clip("a", ready=True).id
    for change in range(6):
        with store.write() as tx:
            if change == 0:
                clips.requeue(tx, clip_id)
            elif change == 1:
                clips.set_processing(tx, clip_id)
            elif change in (2, 3):
                clips.keep_analysis(tx, clip_id, ClipWarning("again", f"{change}"))
            elif change == 4:  # as `mend` does
                tx.execute(update(t.clips).values(warnings=[{"code": "x", "detail": "y"}]))
            else:
                tx.execute(update(t.clips).values(origin_deleted=True))
        assert _read(store, kept, clip_id) == {clip_id: None}, change
        assert _read(store, kept, clip_id) == {clip_id: b""}


def test_clips_that_are_not_ready_are_never_kept(store: Store, add_clip: AddClip) -> None:
    kept, clip_id = KeptClips(), add_clip("a").id
    assert _read(store, kept, clip_id) == _read(store, kept, clip_id) == {clip_id: None}


def test_a_key_of_one_source_gets_no_text_of_another(store: Store, add_clip: AddClip) -> None:
    kept = KeptClips()
    ids = [add_clip(name, ready=True, source=name).id for name in ("a", "b")]
    _read(store, kept, *ids)
    assert _read(store, kept, *ids).keys() == {*ids}
    with visibility.only_source("a"):
        assert _read(store, kept, *ids) == {ids[0]: b""}


def test_a_deleted_clip_is_gone(store: Store, add_clip: AddClip) -> None:
    kept, clip_id = KeptClips(), add_clip("a", ready=True).id
    _read(store, kept, clip_id)
    with store.write() as tx:
        clips.delete_clip(tx, clip_id)
    assert _read(store, kept, clip_id) == {}


def test_texts_that_were_not_used_go_first(store: Store, add_clip: AddClip) -> None:
    kept = KeptClips(max_bytes=2 * OVERHEAD)
    first, second, third = (add_clip(name, ready=True).id for name in "abc")
    _read(store, kept, first, second)
    _read(store, kept, first)
    _read(store, kept, third)
    assert _read(store, kept, first, third) == {first: b"", third: b""}
    assert _read(store, kept, second) == {second: None}


def test_plain_columns_are_not_kept(store: Store, add_clip: AddClip) -> None:
    clip_id = add_clip("a", ready=True).id
    with store.read() as tx:
        found = KeptClips().read(tx, [clip_id], frozenset({"name"}) & PLAIN)
    assert (found[clip_id].name, found[clip_id].keep) == ("a", None)


def test_the_memory_is_bounded() -> None:
    assert kept_clips.MAX_BYTES <= 2**27
