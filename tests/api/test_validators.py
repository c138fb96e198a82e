"""ETag and If-None-Match: 304 until something that the answer shows has changed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip, demo_clips
from tests.live import Live, serve

VIEWS = ["", "/motion", "/motion?fps=10", "/thumbnail.svg", "/animation.svg", "/descriptor"]
VIEWS += ["/ssm.svg", "/msv.svg?slices=4"]
VIEWS += ["/symbol/motion", "/export?format=bvh", "/file"]


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, str]]:
    """A service with one ready clip that tests may change."""
    clip: DemoClip = next(demo_clips(["ada"], ["wave"], takes=1))
    with serve(tmp_path_factory.mktemp("tags") / "data", worker=True) as live:
        created = live.upload(clip).json()
        assert live.wait_for_job(created["job"]["id"])["state"] == "succeeded"
        yield live, f"/v1/clips/{created['clip']['id']}"


def tag_of(client: httpx2.Client, path: str, **headers: str) -> str:
    answer = client.get(path, headers=headers)
    assert answer.status_code == 200, answer.text
    assert answer.headers["cache-control"] == "private, no-cache"
    tag: str = answer.headers["etag"]
    return tag


def status(client: httpx2.Client, path: str, tag: str, **headers: str) -> int:
    answer = client.get(path, headers={"If-None-Match": tag, **headers})
    if answer.status_code == 304:
        assert answer.content == b""
        assert answer.headers["etag"].removeprefix("W/") in tag
        assert answer.headers["x-content-type-options"] == "nosniff"
    return answer.status_code


@pytest.mark.parametrize("view", VIEWS)
def test_an_unchanged_answer_is_not_sent_again(own: tuple[Live, str], view: str) -> None:
    live, path = own
    with live.client() as client:
        tag = tag_of(client, path + view)
        assert status(client, path + view, tag) == 304
        assert status(client, path + view, tag.removeprefix("W/")) == 304
        assert status(client, path + view, f'"other", {tag}') == 304
        assert status(client, path + view, '"other"') == 200


def test_each_form_of_an_answer_has_its_own_tag(own: tuple[Live, str]) -> None:
    live, path = own
    with live.client() as client:
        octets = {"Accept": "application/octet-stream"}
        tags = {
            tag_of(client, f"{path}/motion"),
            tag_of(client, f"{path}/motion", **octets),
            tag_of(client, f"{path}/motion?joints=roles"),
            tag_of(client, f"{path}/symbol/motion"),
            tag_of(client, path),
            tag_of(client, f"{path}?fields=id"),
        }
        assert len(tags) == 6
        assert status(client, f"{path}/motion", tag_of(client, f"{path}/motion"), **octets) == 200


@pytest.mark.parametrize("view", ["", "/motion", "/thumbnail.svg"])
def test_a_change_is_seen(own: tuple[Live, str], view: str) -> None:
    live, path = own
    with live.client() as client:
        before = tag_of(client, path + view)
        count = client.get("/v1/clips").json()["items"][0]["words"]
        changed: Any = client.patch(path, json={"words": [*count, f"word{len(count)}"]})
        assert changed.status_code == 200
        assert status(client, path + view, before) == 200


def test_a_new_analysis_is_seen(own: tuple[Live, str]) -> None:
    live, path = own
    with live.client() as client:
        before = tag_of(client, f"{path}/motion")
        rate = client.get(path).json()["frame_rate"]
        client.patch(path, json={"frame_rate": rate / 2})
        job = client.get("/v1/jobs").json()["items"][0]["id"]
        assert live.wait_for_job(job)["state"] == "succeeded"
        assert status(client, f"{path}/motion", before) == 200


def test_what_depends_on_other_clips_has_no_tag(own: tuple[Live, str]) -> None:
    live, path = own
    with live.client() as client:
        answer = client.get(f"{path}/animation.svg?dimensions=2")
        assert answer.status_code == 200
        assert "etag" not in answer.headers


def test_a_refusal_has_no_tag(idle: httpx2.Client) -> None:
    for path in ("/v1/clips/nope", "/v1/clips/nope/motion", "/v1/clips/nope/file"):
        answer = idle.get(path, headers={"If-None-Match": "*"})
        assert answer.status_code == 404
        assert "etag" not in answer.headers


def test_a_part_of_a_file_is_sent_only_of_the_same_file(own: tuple[Live, str]) -> None:
    live, path = own
    with live.client() as client:
        tag = client.get(f"{path}/file").headers["etag"]
        some = {"Range": "bytes=0-9"}
        assert client.get(f"{path}/file", headers={**some, "If-Range": tag}).status_code == 206
        other = client.get(f"{path}/file", headers={**some, "If-Range": '"other"'})
        assert other.status_code == 200
