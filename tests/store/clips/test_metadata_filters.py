"""Filters by metadata and words: the same clips whether few or many have a value, and quickly."""

from __future__ import annotations

from datetime import timedelta

import pytest
from sqlalchemy import insert

from app.store.clips import listing
from app.store.clips.filter import ClipFilter, MetadataCondition
from app.store.database.ids import new_id, utc_now
from app.store.database.tables import clip_metadata, clips
from app.store.store import Store
from tests.cpu_time import cpu_seconds_below
from tests.store.conftest import AddClip

TIRED = MetadataCondition("condition", ("tired",))
CLIPS = {
    "a": ({"condition": "tired", "age": 30}, ("walk",)),
    "b": ({"condition": "tired", "age": 41}, ("walk", "slow")),
    "c": ({"condition": "rested", "age": 30}, ("run",)),
    "d": ({}, ("walk",)),
}


@pytest.mark.parametrize("few", [0, 1, 1000])
@pytest.mark.parametrize(
    ("filter", "names"),
    [
        (ClipFilter(metadata=(TIRED,)), ["a", "b"]),
        (ClipFilter(metadata=(TIRED, MetadataCondition("age", maximum=35))), ["a"]),
        (ClipFilter(metadata=(TIRED,), word=("slow",)), ["b"]),
        (ClipFilter(word=("walk",)), ["a", "b", "d"]),
        (ClipFilter(metadata=(MetadataCondition("age", minimum=50),)), []),
        (ClipFilter(metadata=(MetadataCondition("age", ("30",), is_negated=True),)), ["b", "d"]),
    ],
)
def test_the_page_does_not_depend_on_how_many_clips_have_a_value(
    store: Store,
    add_clip: AddClip,
    monkeypatch: pytest.MonkeyPatch,
    few: int,
    filter: ClipFilter,
    names: list[str],
) -> None:
    monkeypatch.setattr(listing, "FEW", few)
    for name, (metadata, words) in CLIPS.items():
        add_clip(name, metadata=metadata, words=words)
    with store.read() as tx:
        for sort in ("name", "created_at"):
            page = listing.list_clips(tx, filter, sort=sort)
            assert [clip.name for clip in page.items] == names
        assert listing.count_clips(tx, filter) == len(names)


@pytest.mark.slow
def test_a_value_that_many_clips_have_is_found_quickly(store: Store) -> None:
    now = utc_now()
    clip = {"file_name": "a.bvh", "file_size": 1, "state": "ready", "searched": "a"}
    rows = [
        {
            "id": new_id("clip"),
            "content_key": str(number),
            "sha256": str(number),
            "name": str(number),
            "name_folded": str(number),
            "changed_version": number,
            "created_at": now - timedelta(seconds=number),
            **clip,
        }
        for number in range(100_000)
    ]
    conditions = ("tired", "rested", "warm")
    values = [
        {"clip_id": row["id"], "key": "condition", "kind": "string", "text": conditions[index % 3]}
        for index, row in enumerate(rows)
    ]
    with store.write() as tx:
        tx.execute(insert(clips), rows)
        tx.execute(insert(clip_metadata), values)
    filter = ClipFilter(metadata=(TIRED,))
    with store.read() as tx:
        listing.list_clips(tx, filter)  # statements are compiled once
        listing.total(tx, filter)
        with cpu_seconds_below(0.1, "a page of a third of 100,000 clips, and their number"):
            page, total = listing.list_clips(tx, filter), listing.total(tx, filter)
    assert [clip.name for clip in page.items[:3]] == ["0", "3", "6"]
    assert total.count == 33_334
