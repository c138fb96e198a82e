"""A key for one source sees only the clips of this source, on every route that it may call."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest
from fastapi.routing import APIRoute

from app.api.app import ROUTES
from app.api.deps import Allows
from app.config import load_settings
from app.demo import demo_clips
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from tests.api.conftest import assert_problem
from tests.live import ACTORS, TASKS, Live, serve

OWN, OTHER = "lab a", "lab b"


@pytest.fixture(scope="module")
def labs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, str]]:
    """A service with clips of two sources and fitted models; the key of one source."""
    with serve(tmp_path_factory.mktemp("labs") / "data", worker=True) as live:
        jobs = []
        for number, clip in enumerate(demo_clips(ACTORS, TASKS, takes=2)):
            source = OWN if number % 2 else OTHER
            jobs.append(live.upload(clip, source=source, metadata=json.dumps({"of": source})))
        for job in jobs:
            assert live.wait_for_job(job.json()["job"]["id"])["state"] == "succeeded"
        with live.client() as client:
            fit = client.post("/v1/models/fit").json()["job"]["id"]
        assert live.wait_for_job(fit)["state"] == "succeeded"
        settings = load_settings(data_dir=live.data_dir)
        store = Store.open(settings.database, settings.files_dir)
        with live.client() as client:
            found = client.get("/v1/clips", params={"limit": 100}).json()["items"]
        by_source = {clip["source"]: clip["id"] for clip in found}
        with store.write() as tx:
            secret = keys.create(tx, KeyRole.READ, "lab", source=OWN).secret
        store.close()
        yield live, f"{secret} {by_source[OWN]} {by_source[OTHER]}"


@pytest.fixture
def lab(labs: tuple[Live, str]) -> Iterator[tuple[httpx2.Client, str, str]]:
    """A client with the key, a clip of its source, and a clip of the other one."""
    live, texts = labs
    secret, own, other = texts.split()
    with live.client(headers={"X-API-Key": secret}) as client:
        yield client, own, other


def _clips(answer: httpx2.Response) -> list[dict[str, Any]]:
    assert answer.status_code == 200, answer.text
    items: list[dict[str, Any]] = answer.json()["items"]
    return [item.get("clip", item) for item in items]


def test_lists_searches_and_manifests_hold_only_its_clips(
    lab: tuple[httpx2.Client, str, str],
) -> None:
    client, own, _ = lab
    everything = client.get("/v1/clips", params={"limit": 100})
    assert everything.json()["total"] == 6
    bodies: list[tuple[str, dict[str, Any]]] = [
        *(("motion", {"clip_id": own, "method": method}) for method in ("fused", "vector", "dtw")),
        ("motion", {"clip_id": own, "method": "metric-task"}),
        ("motion", {"clip_id": own, "scope": "windows", "start": 0.0, "end": 1.0}),
        ("motion", {"clip_id": own, "scope": "segments"}),
        ("motion", {"clip_id": own, "filter": {"source": [OWN, OTHER]}, "include_self": True}),
        ("motion", {"clip_id": own, "filter": {"not_source": OWN}}),
        ("words", {"words": ["walk"]}),
        ("words", {"words": ["walk"], "filter": {"source": OTHER}}),
        ("pose", {"clip_id": own, "time": 0.5}),
    ]
    answers = [everything]
    answers += [
        client.post(f"/v1/search/{kind}", json={**body, "limit": 50}) for kind, body in bodies
    ]
    parts = {"examples": [{"clip_id": own}], "words": ["walk"], "limit": 50}
    answers.append(client.post("/v1/search", json=parts))
    for answer in answers:
        assert {clip["source"] for clip in _clips(answer)} <= {OWN}, answer.request.content
    assert sum(bool(_clips(answer)) for answer in answers) >= len(answers) - 3
    assert _clips(client.get("/v1/clips", params={"source": OTHER})) == []
    fields = client.get("/v1/clips", params={"fields": "id,source", "limit": 100})
    assert {clip["source"] for clip in _clips(fields)} == {OWN}
    lines = client.get("/v1/manifest.csv").text.splitlines()
    assert len(lines) == 1 + 6
    assert OTHER not in "\n".join(lines)


def test_clips_of_others_do_not_exist(lab: tuple[httpx2.Client, str, str]) -> None:
    client, own, other = lab
    views = ["", "/file", "/motion", "/descriptor", "/thumbnail.svg", "/keyposes", "/segments"]
    views += ["/annotations", "/annotations/file"]
    views += ["/export?format=bvh", "/low-dimensional", "/animation.svg", "/symbol/motion"]
    for view in views:
        assert client.get(f"/v1/clips/{own}{view}").status_code == 200, view
        assert_problem(client.get(f"/v1/clips/{other}{view}"), 404, "clip_not_found")
    tag = {"If-None-Match": "*"}
    assert client.get(f"/v1/clips/{other}/motion", headers=tag).status_code == 404
    for query in (f"{own}/alignment?other={other}", f"{own}/low-dimensional?model_clips={other}"):
        assert_problem(client.get(f"/v1/clips/{query}"), 404, "clip_not_found")
    for kind, body in (
        ("/motion", {"clip_id": other}),
        ("/pose", {"clip_id": other, "time": 0.0}),
        ("", {"examples": [{"clip_id": own}, {"clip_id": other}]}),
        ("/why", {"examples": [{"clip_id": own}], "hit": other}),
    ):
        assert_problem(client.post(f"/v1/search{kind}", json=body), 404, "clip_not_found")


def test_the_file_of_another_source_is_not_known_either(
    lab: tuple[httpx2.Client, str, str], labs: tuple[Live, str]
) -> None:
    client, _, _ = lab
    clip = next(demo_clips(ACTORS, TASKS, takes=2))  # it is stored, in the other source
    files = {"file": (clip.path, clip.content)}
    answer = client.post("/v1/search/motion", files=files, data={"limit": "50"})
    assert {one["source"] for one in _clips(answer)} == {OWN}


def test_other_calls_are_refused(lab: tuple[httpx2.Client, str, str]) -> None:
    client, own, _ = lab
    refused = ["/v1/persons", "/v1/words", "/v1/sources", "/v1/metadata", "/v1/folders", "/v1/jobs"]
    refused += ["/v1/models", "/v1/space", "/v1/status", "/v1/evaluations", "/metrics", "/v1/audit"]
    for path in refused:
        assert_problem(client.get(path), 403, "forbidden")
    assert_problem(client.post("/v1/recognize", json={"clip_id": own}), 403, "forbidden")
    assert_problem(client.delete(f"/v1/clips/{own}"), 403, "forbidden")
    session = client.get("/v1/session").json()
    assert (session["role"], session["source"]) == ("read", OWN)


def test_the_index_of_everybody_else_stays_whole(
    lab: tuple[httpx2.Client, str, str], labs: tuple[Live, str]
) -> None:
    """The first search of a service may be one of such a key, and it loads the indexes."""
    live, texts = labs
    settings = load_settings(data_dir=live.data_dir)
    store = Store.open(settings.database, settings.files_dir)
    with store.write() as tx:
        reader = keys.create(tx, KeyRole.READ, "all").secret
    store.close()
    _, own, _ = texts.split()
    with live.client(headers={"X-API-Key": reader}) as client:
        for body in ({"clip_id": own}, {"clip_id": own, "scope": "segments"}):
            answer = client.post("/v1/search/motion", json={**body, "limit": 50})
            assert {one["source"] for one in _clips(answer)} == {OWN, OTHER}


def test_every_route_with_such_keys_is_known() -> None:
    """A new route takes such keys only if somebody has checked that it shows no other clips."""
    open_to_source = {
        route.name
        for module in ROUTES
        for route in module.router.routes
        if isinstance(route, APIRoute)
        for dependency in route.dependencies
        if isinstance(dependency.dependency, Allows) and dependency.dependency.is_of_source
    }
    assert open_to_source == {
        *("list_clips", "get_clip", "get_file", "get_audio", "get_motion", "get_descriptor"),
        *("get_thumbnail", "get_alignment", "get_keyposes", "get_segments", "get_low_dimensional"),
        *("get_animation", "get_export", "get_symbol_motion", "get_manifest"),
        *("get_self_similarity", "get_motion_volume"),
        *("list_annotations", "get_annotation", "get_annotation_file", "get_annotation_table"),
        *("search_motion", "search_words", "search_pose", "search_parts"),
        "explain_search",
    }
