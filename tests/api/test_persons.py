"""Forgetting a person over HTTP, with any characters in the name."""

from __future__ import annotations

import json
from urllib.parse import quote

import httpx2
import pytest

from tests.api.conftest import assert_problem
from tests.live import Live

FILE = b"HIERARCHY\nROOT Hips\n{"


def forget(client: httpx2.Client, name: str) -> httpx2.Response:
    # quote() keeps full stops, but a client would resolve them as a relative path
    return client.delete("/v1/persons/" + quote(name, safe="").replace(".", "%2E"))


def names(client: httpx2.Client) -> set[str]:
    return {one["name"] for one in client.get("/v1/persons").json()["items"]}


@pytest.mark.parametrize(
    "name",
    ["a/b", "x/", "/x", "/", "a//b", "../up", ".", "..", "%", "a%2Fb", "a?b#c", "Ana Žižka", "a+b"],
)
def test_a_person_of_any_name_is_forgotten(idle: httpx2.Client, name: str) -> None:
    uploaded = idle.post("/v1/clips", files={"file": ("a.bvh", FILE)}, data={"person": name})
    assert uploaded.is_success, uploaded.text
    path = f"/v1/clips/{uploaded.json()['clip']['id']}"
    try:
        idle.patch(path, json={"person": name})  # the file may have been there
        assert name in names(idle)
        assert forget(idle, name + "/").status_code == 404  # another name, and no redirect
        assert forget(idle, name).status_code == 204
        assert name not in names(idle)
        assert idle.get(path).json()["person"] is None
    finally:
        idle.delete(path)


def test_the_log_has_no_name_of_a_forgotten_person(idle_service: Live) -> None:
    with idle_service.client() as client:
        names = {"Unheard Of": "one.forgotten", "un/heard of/": "two.forgotten"}
        for name, request_id in names.items():
            url = "/v1/persons/" + quote(name, safe="")
            answer = client.delete(url, headers={"X-Request-Id": request_id})
            assert answer.status_code == 404
    text = idle_service.log.read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    paths = {line["path"] for line in lines if line.get("request_id", "").endswith(".forgotten")}
    assert paths == {"/v1/persons/{name}"}
    assert "heard" not in text.lower()


def test_an_impossible_name_of_a_person_is_refused(idle: httpx2.Client) -> None:
    for name in ("a\0b", "a\nb", "a/\nb", "x" * 301):
        assert_problem(forget(idle, name), 422, "bad_field", "path.name")
    assert_problem(forget(idle, "nobody/at/all"), 404, "not_found", "path.name")
    assert idle.get("/v1/persons/").history == []
    assert idle.get("/v1/persons/", follow_redirects=True).status_code == 200


def test_the_description_has_a_plain_path_for_persons(idle: httpx2.Client) -> None:
    paths = idle.get("/openapi.json").json()["paths"]
    (parameter,) = paths["/v1/persons/{name}"]["delete"]["parameters"]
    assert (parameter["name"], parameter["in"]) == ("name", "path")
    assert not [path for path in paths if ":" in path]
    forget(idle, "nobody/at/all")
    counted = idle.get("/metrics").text
    assert "/v1/persons/{name" in counted
    assert "nobody" not in counted
