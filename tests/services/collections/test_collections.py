"""Collections: items, order, filters, exports, statistics, and what deletion and forgetting do."""

from __future__ import annotations

import csv
import io
import zipfile
from typing import Any

import numpy as np
import pytest

from app.errors import BadField, CollectionNotFound, Conflict, NotFound
from app.formats.read import read_recording
from app.services.clips import catalogue as clips
from app.services.clips import persons
from app.services.clips.manifest_export import manifest
from app.services.collections import collections
from app.services.collections.export import export_collection
from app.services.collections.filling import from_filter, from_search
from app.services.collections.statistics import statistics
from app.services.find.by_parts import find_by_parts
from app.services.find.find import find_motion, find_words
from app.services.find.queries import ComposedQuery, Example, MotionQuery, WordQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.store.clips.filter import ClipFilter
from app.store.clips.license_policy import only_licenses
from app.store.clips.record import ClipRecord
from app.store.collections import NewItem


@pytest.fixture
def some(mine: Library) -> list[ClipRecord]:
    return list(clips.list_clips(mine, sort="name", limit=100).items)


def ids_in_order(lib: Library, collection_id: str) -> list[str]:
    return [item.clip.id for item in collections.all_items(lib, collection_id)]


def test_items_keep_their_order(mine: Library, some: list[ClipRecord]) -> None:
    made = collections.create(mine, " mine ", "two\nlines", [NewItem(c.id) for c in some[:3]])
    assert (made.name, made.notes, made.size) == ("mine", "two\nlines", 3)
    assert collections.add_items(mine, made.id, [NewItem(some[0].id, 0.5, 1.0, "again")]).size == 4
    items = collections.all_items(mine, made.id)
    assert [item.clip.id for item in items] == [some[i].id for i in (0, 1, 2, 0)]
    collections.put_in_order(mine, made.id, [items[3].record.id, items[1].record.id])
    assert ids_in_order(mine, made.id) == [some[i].id for i in (0, 1, 0, 2)]
    collections.remove_item(mine, made.id, items[1].record.id)
    assert ids_in_order(mine, made.id) == [some[i].id for i in (0, 0, 2)]
    pages, cursor = [], None
    while True:
        page = collections.items_page(mine, made.id, 2, cursor)
        pages += [item.clip.id for item in page.items]
        cursor = page.next
        if cursor is None:
            break
    assert pages == ids_in_order(mine, made.id)


def test_items_and_collections_are_changed(mine: Library, some: list[ClipRecord]) -> None:
    made = collections.create(mine, "one", "", [NewItem(some[0].id)])
    (item,) = collections.all_items(mine, made.id)
    changed = collections.change_item(
        mine, made.id, item.record.id, {"start": 0.2, "end": 0.9, "notes": "best"}
    )
    assert (changed.record.start, changed.record.end, changed.record.notes) == (0.2, 0.9, "best")
    assert changed.seconds == pytest.approx(0.7)
    assert collections.change(mine, made.id, {"name": "two"}).name == "two"
    collections.create(mine, "one")
    with pytest.raises(Conflict):
        collections.change(mine, made.id, {"name": "one"})
    with pytest.raises(BadField):
        collections.change_item(mine, made.id, item.record.id, {"end": 0.1})
    collections.remove(mine, made.id)
    with pytest.raises(CollectionNotFound):
        collections.get(mine, made.id)
    assert clips.get_clip(mine, some[0].id)


@pytest.mark.parametrize(
    ("item", "place"),
    [
        (NewItem("clip_none"), "items.0.clip_id"),
        (NewItem("", start=3.0, end=2.0), "items.0.end"),
        (NewItem("", start=500.0), "items.0.end"),
        (NewItem("", end=float("nan")), "items.0.end"),
        (NewItem("", start=500.0, end=501.0), "items.0.start"),
    ],
)
def test_an_item_that_makes_no_sense_is_refused(
    mine: Library, some: list[ClipRecord], item: NewItem, place: str
) -> None:
    asked = NewItem(item.clip_id or some[0].id, item.start, item.end)
    with pytest.raises(BadField) as refused:
        collections.create(mine, "bad", "", [asked])
    assert [one.location for one in refused.value.places] == [place]
    assert collections.list_page(mine, 10).total == 0


def test_what_is_not_there_is_not_found(mine: Library) -> None:
    made = collections.create(mine, "empty")
    with pytest.raises(NotFound):
        collections.remove_item(mine, made.id, "item_none")
    with pytest.raises(BadField):
        collections.put_in_order(mine, made.id, ["item_none"])
    with pytest.raises(CollectionNotFound):
        collections.add_items(mine, "collection_none", [])


def test_a_collection_is_made_from_a_filter_and_from_a_search(
    mine: Library, some: list[ClipRecord]
) -> None:
    kicks = {clip.id for clip in some if clip.task == "kick"}
    assert {item.clip_id for item in from_filter(mine, {"task": "kick"})} == kicks
    query = ComposedQuery(
        examples=[Example("examples.0", QuerySource(clip_id=some[0].id))], limit=3
    )
    hits = [hit.clip.id for hit in find_by_parts(mine, query).items]
    assert [item.clip_id for item in from_search(mine, query)] == hits


def test_lists_and_searches_are_filtered_by_collection(
    mine: Library, some: list[ClipRecord]
) -> None:
    inside = some[::2]
    made = collections.create(mine, "half", "", [NewItem(c.id, 0.0, 0.5) for c in inside])
    expected = {clip.id for clip in inside}
    given: dict[str, Any] = {"collection": made.id}
    listed = clips.list_clips(mine, ClipFilter(collection=(made.id,)), limit=100)
    assert {clip.id for clip in listed.items} == expected
    assert listed.total == len(expected)
    source = QuerySource(clip_id=some[1].id)
    for scope in ("clips", "windows", "segments"):
        found = find_motion(mine, MotionQuery(source=source, filter=given, limit=50, scope=scope))
        assert {hit.clip.id for hit in found.items} <= expected, scope
        assert found.items
    words = find_words(mine, WordQuery(words=["walk"], filter=given, limit=50))
    assert {hit.clip.id for hit in words.items} == expected
    both = ComposedQuery(
        examples=[Example("examples.0", source)], words=["walk"], filter=given, limit=50
    )
    assert {hit.clip.id for hit in find_by_parts(mine, both).items} == expected
    rows = list(
        csv.DictReader(
            io.StringIO(b"".join(manifest(mine, ClipFilter(collection=(made.id,)))).decode())
        )
    )
    assert len(rows) == len(expected)
    collections.add_items(mine, made.id, [NewItem(some[1].id)])
    again = find_motion(mine, MotionQuery(source=source, filter=given, limit=50, include_self=True))
    assert some[1].id in {hit.clip.id for hit in again.items}
    with pytest.raises(BadField, match="filter"):
        find_motion(mine, MotionQuery(source=source, filter={"collection": "collection_none"}))


def zipped(lib: Library, collection_id: str, format: str, **options: Any) -> zipfile.ZipFile:
    file = export_collection(lib, collection_id, format, **options)
    assert file.file_name.endswith(".zip")
    found = zipfile.ZipFile(io.BytesIO(b"".join(file.blocks)))
    assert found.testzip() is None
    return found


def test_a_collection_is_exported_with_manifest_licenses_and_credits(
    mine: Library, some: list[ClipRecord]
) -> None:
    clips.update_clip(mine, some[1].id, {"license": None, "person": None})
    items = [NewItem(some[1].id), NewItem(some[0].id, 0.5, 1.0, "=best\npart"), NewItem(some[0].id)]
    made = collections.create(mine, "for / export", "", items)
    archive = zipped(mine, made.id, "bvh")
    files = [name for name in archive.namelist() if name.endswith(".bvh")]
    assert [name[0] for name in files] == ["1", "2", "3"]
    rows = list(csv.DictReader(io.StringIO(archive.read("manifest.csv").decode())))
    assert [row["path"] for row in rows] == files
    assert [row["task"] for row in rows] == [some[1].task, some[0].task, some[0].task]
    assert (rows[1]["meta.part_start"], rows[1]["unit"]) == ("0.5", "cm")
    assert rows[1]["meta.item_notes"].lstrip("'") == "=best part"
    motion = load_motion(mine, some[0])
    part = read_recording(archive.read(files[1]))
    first = round(0.5 * motion.frame_rate)
    order = [part.skeleton.names.index(name) for name in motion.names]
    cut = motion.positions[first : round(motion.frame_rate)]
    assert np.abs(part.positions[:, order] * 0.01 - cut).max() < 1e-4
    licenses, credit = (archive.read(f"{name}.txt").decode() for name in ("LICENSES", "CREDITS"))
    assert "CC0-1.0 (2)" in licenses
    assert "no license is stored (1)" in licenses
    assert f"performed by: {some[0].person}" in credit
    assert "demo: 3 files" in credit


def test_a_collection_is_exported_on_one_body_in_any_format(
    mine: Library, some: list[ClipRecord]
) -> None:
    items = [NewItem(some[0].id, 0.2, 0.8), NewItem(some[-1].id)]
    made = collections.create(mine, "c", "", items)
    for format in ("npz", "csv", "glb", "c3d", "trc"):
        archive = zipped(mine, made.id, format, skeleton="canonical", fps=20)
        files = [name for name in archive.namelist() if name.endswith(f".{format}")]
        assert len(set(files) - {"manifest.csv"}) == 2
    with pytest.raises(BadField):
        export_collection(mine, made.id, "glb", unit="in")
    assert zipped(mine, collections.create(mine, "none").id, "bvh").namelist() == [
        "manifest.csv",
        "LICENSES.txt",
        "CREDITS.txt",
    ]


def test_a_license_that_is_not_allowed_is_left_out_of_the_export(
    mine: Library, some: list[ClipRecord]
) -> None:
    made = collections.create(mine, "licensed", items=[NewItem(clip.id) for clip in some[:2]])
    clips.update_clip(mine, some[1].id, {"license": "private"})
    with only_licenses(("CC0-1.0",)):
        archive = zipped(mine, made.id, "bvh")
    rows = list(csv.DictReader(io.TextIOWrapper(archive.open("left_out.csv"), "utf-8")))
    assert [row["clip_id"] for row in rows] == [some[1].id]
    assert "private" in rows[0]["reason"]


def test_a_clip_that_is_not_ready_is_left_out_of_the_export(
    mine: Library, some: list[ClipRecord]
) -> None:
    created = clips.create_clip(mine, io.BytesIO(b"HIERARCHY\nROOT a\n{\n}"), "bad.bvh", {})
    made = collections.create(mine, "c", "", [NewItem(created.clip.id), NewItem(some[0].id)])
    archive = zipped(mine, made.id, "bvh")
    rows = list(csv.DictReader(io.StringIO(archive.read("left_out.csv").decode())))
    assert [row["clip_id"] for row in rows] == [created.clip.id]
    assert len([name for name in archive.namelist() if name.endswith(".bvh")]) == 1


def test_statistics_say_what_is_covered_and_propose_what_is_missing(
    mine: Library, some: list[ClipRecord]
) -> None:
    stand = [clip for clip in some if clip.task == "wave"]
    walks = {clip.id for clip in some if clip.task == "walk"}
    made = collections.create(mine, "standing", "", [NewItem(clip.id) for clip in stand])
    found = statistics(mine, made.id)
    assert (found.items, found.clips, found.library_size) == (len(stand), len(stand), len(some))
    assert found.seconds == pytest.approx(sum(clip.duration or 0 for clip in stand))
    assert found.own.cells[2:].sum() == pytest.approx(0)
    assert found.library.cells[2:].sum() > 1
    assert found.pose_share is not None
    assert 0 < found.pose_share < 1
    assert {one.clip.id for one in found.proposals if not one.is_mirror} & walks
    gains = [one.seconds for one in found.proposals]
    assert gains == sorted(gains, reverse=True)
    every = collections.create(mine, "all", "", [NewItem(clip.id) for clip in some])
    whole = statistics(mine, every.id)
    assert whole.pose_share == 1
    assert np.allclose(whole.own.cells, whole.library.cells)
    assert all(one.is_mirror for one in whole.proposals)


def test_a_deleted_clip_leaves_its_collections(mine: Library, some: list[ClipRecord]) -> None:
    made = collections.create(mine, "c", "", [NewItem(some[0].id), NewItem(some[1].id)])
    clips.delete_clip(mine, some[0].id)
    assert ids_in_order(mine, made.id) == [some[1].id]
    assert collections.get(mine, made.id).size == 1


def test_a_forgotten_person_is_in_no_name_and_no_notes(
    mine: Library, some: list[ClipRecord]
) -> None:
    own = next(clip for clip in some if clip.person == "ada")
    made = collections.create(mine, "best of Ada", "ada_01", [NewItem(own.id, notes="Ada kicks")])
    other = collections.create(mine, "best of anonymous", "adamant")
    persons.forget_person(mine, "ada")
    after = collections.get(mine, made.id)
    texts = [after.name, after.notes, collections.all_items(mine, made.id)[0].record.notes]
    assert not any("ada" in text.casefold() for text in texts), texts
    assert collections.get(mine, other.id).notes == "adamant"
