"""Metadata, paths and repeated labels over HTTP: uploads, imports, corrections, searches."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip, demo_clips
from tests.api.conftest import assert_problem
from tests.live import Live
from tests.zip_archives import zip_archive

SOURCE = "labels test"


@pytest.fixture(scope="module")
def clip() -> DemoClip:
    return next(demo_clips(["dele"], ["jump"], takes=1))


@pytest.fixture(scope="module")
def other() -> DemoClip:
    return next(demo_clips(["dele"], ["wave"], takes=1))


@pytest.fixture
def client(demo_service: Live) -> Iterator[httpx2.Client]:
    """A client; the clips of SOURCE are deleted after the test."""
    with demo_service.client() as opened:
        yield opened
        for found in opened.get("/v1/clips", params={"source": SOURCE}).json()["items"]:
            opened.delete(f"/v1/clips/{found['id']}")


def _upload(client: httpx2.Client, clip: DemoClip, **fields: Any) -> httpx2.Response:
    sent = {"source": SOURCE} | fields
    return client.post("/v1/clips", files={"file": ("a.bvh", clip.content)}, data=sent)


def test_bytes_that_are_stored_are_kept_updated_or_refused(
    client: httpx2.Client, clip: DemoClip
) -> None:
    first = _upload(client, clip, person="ann", metadata='{"age": 30, "tired": true}').json()
    assert (first["differences"], first["clip"]["metadata"]) == ([], {"age": 30, "tired": True})
    url = f"/v1/clips/{first['clip']['id']}"

    kept = _upload(client, clip, person="bob", metadata='{"age": 31}')
    assert kept.json()["differences"] == [
        {"field": "meta.age", "stored": 30, "sent": 31, "applied": False},
        {"field": "person", "stored": "ann", "sent": "bob", "applied": False},
    ]
    assert kept.json()["clip"]["person"] == "ann"

    refused = _upload(client, clip, person="bob", words="slow", on_conflict="error")
    assert_problem(refused, 409, "conflict", "body.person", "body.words")
    assert "'ann'" in refused.text
    assert client.get(url).json()["person"] == "ann"
    assert _upload(client, clip, person="ann", on_conflict="error").status_code in (200, 202)

    updated = _upload(client, clip, person="bob", task="", on_conflict="update").json()
    assert [one["applied"] for one in updated["differences"]] == [True]
    assert client.get(url).json()["person"] == "bob"


def test_metadata_are_corrected_listed_filtered_and_searched(
    demo_service: Live, client: httpx2.Client, clip: DemoClip, other: DemoClip
) -> None:
    for one, path, metadata in (
        (clip, "lab/day 1/02_01.bvh", {"condition": "Fatigued", "age": 30, "note": "x"}),
        (other, "lab/day 2/02_01.bvh", {"condition": "fresh", "age": "30"}),
    ):
        reply = _upload(client, one, name="02_01", path=path, metadata=json.dumps(metadata)).json()
        demo_service.wait_for_job(reply["job"]["id"])
    tired, fresh = (_one(client, folder=f"lab/day {day}") for day in (1, 2))
    assert (tired["path"], fresh["path"]) == ("lab/day 1/02_01.bvh", "lab/day 2/02_01.bvh")
    patched = client.patch(
        f"/v1/clips/{tired['id']}", json={"metadata": {"age": 41.5, "note": None}}
    )
    assert patched.json()["metadata"] == {"age": 41.5, "condition": "Fatigued"}
    bad = client.patch(f"/v1/clips/{tired['id']}", json={"metadata": {"person": "x", "a": 1}})
    assert_problem(bad, 422, "bad_field", "body.meta.person")

    for condition, found in (
        ({"meta.condition": "Fatigued"}, [tired]),
        ({"meta.condition": "fatigued"}, []),
        ({"meta.condition": ["Fatigued", "fresh"]}, [tired, fresh]),
        ({"not_meta.condition": "fresh"}, [tired]),
        ({"meta.age": "30"}, [fresh]),
        ({"meta.age.min": 30, "meta.age.max": 41.5}, [tired]),
        ({"folder": "lab"}, [tired, fresh]),
        ({"folder": "lab", "not_folder": "lab/day 1"}, [fresh]),
        ({"folder": "lab/day"}, []),
        ({"q": "DAY 1/02"}, [tired]),
        ({"q": "fatig"}, [tired]),
    ):
        ids = {one["id"] for one in found}
        listed = client.get("/v1/clips", params={"source": SOURCE, **condition}).json()["items"]
        assert {one["id"] for one in listed} == ids, condition
        if "q" in condition:
            continue
        wanted = {"clip_id": tired["id"], "include_self": True, "limit": 100}
        hits = client.post(
            "/v1/search/motion", json={**wanted, "filter": {"source": SOURCE, **condition}}
        )
        assert {hit["clip"]["id"] for hit in hits.json()["items"]} == ids, condition
        mapped = client.get("/v1/space", params={"space": "vectors", "source": SOURCE, **condition})
        assert {one["clip_id"] for one in mapped.json()["items"]} == ids, condition


def _one(client: httpx2.Client, **params: str) -> dict[str, Any]:
    (found,) = client.get("/v1/clips", params=params).json()["items"]
    clip: dict[str, Any] = found
    return clip


def test_keys_and_folders_can_be_discovered(
    client: httpx2.Client, clip: DemoClip, other: DemoClip
) -> None:
    _upload(client, clip, path="disc/a/1.bvh", metadata='{"disc": 1, "disc2": "x"}')
    _upload(client, other, path="disc\\b\\2.bvh", metadata='{"disc": "one"}')
    keys = {key["name"]: key for key in client.get("/v1/metadata").json()["items"]}
    assert keys["disc"]["kinds"] == {"number": 1, "string": 1}
    assert (keys["disc"]["count"], keys["disc"]["minimum"], keys["disc"]["maximum"]) == (2, 1, 1)
    assert sorted(map(str, (one["value"] for one in keys["disc"]["values"]))) == ["1", "one"]
    page = client.get("/v1/metadata", params={"limit": 1}).json()
    rest = client.get("/v1/metadata", params={"cursor": page["next"]}).json()
    assert [key["name"] for key in (*page["items"], *rest["items"])] == list(keys)

    (top,) = [one for one in client.get("/v1/folders").json()["items"] if one["name"] == "disc"]
    assert top == {"name": "disc", "path": "disc", "clips": 2, "subfolders": 2}
    inner = client.get("/v1/folders", params={"folder": "disc", "limit": 1}).json()
    assert [one["path"] for one in inner["items"]] == ["disc/a"]
    more = client.get("/v1/folders", params={"folder": "disc", "cursor": inner["next"]}).json()
    assert ([one["path"] for one in more["items"]], more["next"]) == (["disc/b"], None)


@pytest.mark.parametrize(
    ("condition", "part"),
    [
        ({"meta.age.min": "old"}, "must be a number"),
        ({"meta.": "x"}, "must name a key"),
        ({"meta.a": "x" * 301}, "at most"),
        ({"metadata.a": "x"}, "no such field"),
    ],
)
def test_a_bad_condition_is_refused(
    idle: httpx2.Client, condition: dict[str, str], part: str
) -> None:
    for answer in (
        idle.get("/v1/clips", params=condition),
        idle.post("/v1/search/motion", json={"clip_id": "x", "filter": condition}),
    ):
        assert_problem(answer, 422, "bad_field")
        assert part in answer.text


def test_an_archive_is_imported_again_with_a_correction_after_an_edit(
    demo_service: Live, client: httpx2.Client, clip: DemoClip, other: DemoClip
) -> None:
    def run(table: str, **fields: str) -> dict[str, Any]:
        content = zip_archive(
            {
                "manifest.csv": table.encode(),
                "x/walk.bvh": clip.content,
                "x/kick.bvh": other.content,
                "notes.txt": b"notes",
            }
        ).getvalue()
        sent = {"source": SOURCE, "labels": "{person}/{take}.bvh"} | fields
        answer = client.post("/v1/imports", files={"archive": ("a.zip", content)}, data=sent)
        result: dict[str, Any] = demo_service.wait_for_job(answer.json()["job"]["id"])["result"]
        return result

    first = run("path,task,mood\nx/walk.bvh,wlak,calm\n")
    assert (first["new"], first["skipped"]) == (2, 1)
    kick = _one(client, source=SOURCE, q="x/kick")
    assert (kick["person"], kick["metadata"]) == ("x", {"take": "kick"})
    client.patch(f"/v1/clips/{kick['id']}", json={"person": "ann"})
    again = run("path,task,mood,person\nx/walk.bvh,walk,calm,\nx/kick.bvh,,,bob\n")
    counts = {name: again[name] for name in ("new", "updated", "unchanged", "conflicting")}
    assert counts == {"new": 0, "updated": 1, "unchanged": 0, "conflicting": 1}
    files = {file["path"]: file for file in again["files"]}
    assert files["x/kick.bvh"]["differences"] == [
        {"field": "person", "stored": "ann", "sent": "bob", "applied": False}
    ]
    assert files["notes.txt"]["outcome"] == "skipped"
    won = run("path,person\nx/kick.bvh,bob\n", overwrite="true")
    assert won["updated"] == 1
    assert client.get(f"/v1/clips/{kick['id']}").json()["person"] == "bob"

    table = client.get("/v1/manifest.csv", params={"folder": "x", "source": SOURCE})
    assert table.headers["content-type"] == "text/csv; charset=utf-8"
    rows = {row["path"]: row for row in csv.DictReader(io.StringIO(table.text))}
    assert rows["x/walk.bvh"]["task"] == "walk"
    assert rows["x/walk.bvh"]["meta.mood"] == "calm"
    same = run(table.text)
    assert (same["unchanged"], same["updated"], same["conflicting"]) == (2, 0, 0)


def test_a_typing_error_in_a_column_fails_the_import(
    demo_service: Live, client: httpx2.Client, clip: DemoClip
) -> None:
    content = zip_archive({"manifest.csv": b"path,tsak\n", "a.bvh": clip.content}).getvalue()
    answer = client.post("/v1/imports", files={"archive": ("a.zip", content)})
    job = demo_service.wait_for_job(answer.json()["job"]["id"])
    assert (job["state"], job["error"]["code"]) == ("failed", "unreadable")
    assert "is `task` meant" in job["error"]["detail"]
    bad = client.post("/v1/imports", files={"archive": ("a.zip", content)}, data={"labels": "x"})
    assert_problem(bad, 422, "bad_field", "body.labels")
