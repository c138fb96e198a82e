"""Collections over HTTP and by the Python client, on a running service."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from kinedex import Kinedex, KinedexError
from tests.live import Live


@pytest.fixture
def client(demo_service: Live) -> Iterator[Kinedex]:
    with Kinedex(demo_service.url) as opened:
        yield opened


def test_a_collection_from_its_making_to_its_end(
    client: Kinedex, demo_service: Live, demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    body = {
        "name": "everything",
        "notes": "of the demo",
        "items": [{"clip_id": walk["id"], "start": 0.2, "end": 0.9, "notes": "a step"}],
        "filter": {"task": ["kick"]},
        "search": {"examples": [{"clip_id": walk["id"]}], "limit": 2},
    }
    answer = demo.post("/v1/collections", json=body)
    assert answer.status_code == 201, answer.text
    made = answer.json()
    kicks = demo.get("/v1/clips", params={"task": "kick"}).json()["total"]
    assert made["size"] == 1 + kicks + 2
    items = list(client.collections.items(made["id"]))
    assert (items[0].clip.id, items[0].start, items[0].notes) == (walk["id"], 0.2, "a step")
    client.collections.order(made["id"], [items[-1].id])
    again = list(client.collections.items(made["id"]))
    assert [item.id for item in again] == [items[-1].id, *(item.id for item in items[:-1])]
    assert client.collections.update_item(made["id"], items[0].id, end=None).end is None
    client.collections.remove_item(made["id"], items[-1].id)
    added = client.collections.add(made["id"], items=[{"clip_id": walk["id"]}])
    assert added.size == made["size"]
    assert client.collections.update(made["id"], name="some").name == "some"
    assert "some" in {one.name for one in client.collections.list()}

    listed = demo.get("/v1/clips", params={"collection": made["id"], "limit": 100}).json()
    inside = {item.clip.id for item in client.collections.items(made["id"])}
    assert {clip["id"] for clip in listed["items"]} == inside
    sent = {"clip_id": walk["id"], "filter": {"collection": made["id"]}, "limit": 100}
    hits = demo.post("/v1/search/motion", json=sent).json()["items"]
    assert {hit["clip"]["id"] for hit in hits} == inside - {walk["id"]}

    content = client.collections.export(made["id"], "bvh", skeleton="canonical")
    archive = zipfile.ZipFile(io.BytesIO(content))
    assert archive.testzip() is None
    assert len([n for n in archive.namelist() if n.endswith(".bvh")]) == made["size"]
    assert {"manifest.csv", "LICENSES.txt", "CREDITS.txt"} <= set(archive.namelist())
    job = demo_service.wait_for_job(client.clips.upload_archive(("again.zip", content)).job.id)
    assert job["state"] == "succeeded", job
    copies = demo.get("/v1/clips", params={"meta.clip_id": walk["id"], "limit": 100}).json()
    assert {clip["task"] for clip in copies["items"]} == {"walk"}
    for clip in demo.get("/v1/clips", params={"q": "canonical.bvh", "limit": 100}).json()["items"]:
        demo.delete(f"/v1/clips/{clip['id']}")

    found = client.collections.statistics(made["id"])
    assert found.items == made["size"]
    assert 0 < found.covered_cells <= found.library_cells
    assert sum(cell.seconds for cell in found.cells) > 1
    actions = {row.action for row in client.service.audit()}
    assert {"create_collection", "add_items", "export_collection_as_zip"} <= actions
    client.collections.delete(made["id"])
    with pytest.raises(KinedexError) as gone:
        client.collections.get(made["id"])
    assert gone.value.code == "collection_not_found"
    refused = demo.get("/v1/clips", params={"collection": made["id"]})
    assert refused.status_code == 422


def test_wrong_collections_are_refused(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    unknown = {"name": "x", "items": [{"clip_id": "clip_none"}]}
    answer = demo.post("/v1/collections", json=unknown)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["location"] == "body.items.0.clip_id"
    assert demo.post("/v1/collections", json={"name": " "}).status_code == 422
    first = demo.post("/v1/collections", json={"name": "twice"})
    assert demo.post("/v1/collections", json={"name": "twice"}).status_code == 409
    assert demo.delete(f"/v1/collections/{first.json()['id']}").status_code == 204
    assert demo.get("/v1/collections/collection_none/export?format=bvh").status_code == 404


def test_a_saved_search_is_run_and_tells_what_is_new(
    client: Kinedex, demo_service: Live, demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    query = {
        "examples": [{"clip_id": walk["id"]}],
        "limit": 5,
        "filter": {"task": ["walk", "walk again"], "not_meta.age": 3},
    }
    answer = demo.post("/v1/searches", json={"name": "like a walk", "query": query})
    assert answer.status_code == 201, answer.text
    saved = answer.json()
    assert saved["query"] == query
    assert [one.name for one in client.searches.list()] == ["like a walk"]
    run = demo.get(f"/v1/searches/{saved['id']}/hits").json()["items"]
    assert run == demo.post("/v1/search", json=query).json()["items"]
    assert client.searches.new_hits(saved["id"]).items == []
    made = client.clips.edit(walk["id"], [{"kind": "resample", "fps": 20}])
    assert made.job is not None
    demo_service.wait_for_job(made.job.id)
    (new,) = client.searches.new_hits(saved["id"]).items
    assert new.clip.id == made.clip.id
    client.searches.mark_seen(saved["id"])
    assert client.searches.new_hits(saved["id"]).items == []
    assert client.searches.update(saved["id"], name="other").name == "other"
    short = demo.get(f"/v1/searches/{saved['id']}/hits", params={"limit": 1, "fields": "rank"})
    assert short.json()["items"] == [{"rank": 1}]
    client.clips.delete(made.clip.id)
    client.searches.delete(saved["id"])
    assert demo.get(f"/v1/searches/{saved['id']}").status_code == 404
