"""Every text and list that a client sends has a bound, in the schema and in the service."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.kinedex_error import MAX_DETAIL, MAX_STORED_PLACES, KinedexError, Place
from tests.api.conftest import assert_problem
from tests.live import Live

LONG = "x" * 60_000
BOUNDED_TEXT = {"maxLength", "enum", "const", "format", "contentSchema"}
"""Members of a schema that bound a text. contentSchema: JSON in a field of a form, which has at
most 64 KiB."""


def _unbounded(schema: dict[str, Any], description: dict[str, Any], where: str) -> Iterator[str]:
    """Locations in a schema that take a text, a list or a mapping of any length."""
    if "$ref" in schema:
        schema = description["components"]["schemas"][schema["$ref"].rpartition("/")[2]]
    if "enum" in schema or "const" in schema:
        return
    kind = schema.get("type")
    if kind == "string" and not BOUNDED_TEXT & schema.keys():
        yield where
    if kind == "array" and "maxItems" not in schema:
        yield where
    if kind == "object" and schema.get("additionalProperties") and "maxProperties" not in schema:
        yield where
    inner = [*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ())]
    inner += [
        schema[key] for key in ("items", "contentSchema") if isinstance(schema.get(key), dict)
    ]
    if isinstance(schema.get("additionalProperties"), dict):
        inner.append(schema["additionalProperties"])
    for part in inner:
        yield from _unbounded(part, description, where)
    for name, part in schema.get("properties", {}).items():
        yield from _unbounded(part, description, f"{where}.{name}")


def test_every_text_and_list_of_a_request_has_a_bound_in_its_schema(idle: httpx2.Client) -> None:
    description = idle.get("/openapi.json").json()
    found: list[str] = []
    for path, calls in description["paths"].items():
        for verb, call in calls.items():
            for parameter in call.get("parameters", ()):
                where = f"{verb} {path} {parameter['name']}"
                found += _unbounded(parameter["schema"], description, where)
            for content in call.get("requestBody", {}).get("content", {}).values():
                found += _unbounded(content["schema"], description, f"{verb} {path}")
    assert found == []


@pytest.mark.parametrize(
    ("verb", "path", "body", "location"),
    [
        ("POST", "/v1/search/motion", {"clip_id": LONG}, "body.clip_id"),
        ("POST", "/v1/search", {"examples": [{"clip_id": "a"}] * 21}, "body.examples"),
        ("POST", "/v1/search", {"words": [LONG]}, "body.words.0"),
        ("POST", "/v1/search/words", {"words": ["a"] * 101}, "body.words"),
        ("POST", "/v1/search/words", {"words": [LONG]}, "body.words.0"),
        (
            "POST",
            "/v1/search/words",
            {"words": ["a"], "filter": {"person": ["p"] * 50_000}},
            "body.filter.person",
        ),
        ("POST", "/v1/search/pose", {"positions": [[0, 0, 0]] * 50_000}, "body.positions"),
        ("POST", "/v1/search/pose", {"positions": [[10**400, 0, 0]] * 13}, "body.positions.0"),
        ("POST", "/v1/synthesize", {"task": LONG, "person": "a"}, "body.task"),
        ("POST", "/v1/synthesize", {"task": "a", "clip_ids": ["c"] * 101}, "body.clip_ids"),
        ("PATCH", "/v1/clips/none", {"words": ["w"] * 101}, "body.words"),
        ("PATCH", "/v1/clips/none", {"beats": [1.0] * 10_001}, "body.beats"),
        ("PUT", "/v1/clips/none/keyposes", {"times": [1.0] * 10_001}, "body.times"),
        ("POST", "/v1/clips/none/word-suggestions/accept", {"words": [LONG]}, "body.words.0"),
        (
            "POST",
            "/v1/studies/low-dimensional/pairs",
            {"clip_id": "c", "model_clips": [LONG]},
            "body.model_clips.0",
        ),
        ("GET", f"/v1/clips/{'x' * 101}", None, "path.clip_id"),
        ("GET", f"/v1/jobs/{'x' * 101}", None, "path.job_id"),
        ("DELETE", f"/v1/persons/{'x' * 301}", None, "path.name"),
    ],
)
def test_too_long_values_are_refused_with_a_short_answer(
    demo: httpx2.Client, verb: str, path: str, body: dict[str, Any] | None, location: str
) -> None:
    answer = demo.request(verb, path, json=body)
    assert_problem(answer, 422, "bad_field", location)
    assert len(answer.content) < 10_000


@pytest.mark.parametrize(
    "roles",
    [{"hips": LONG}, {LONG: "Hips"}, {f"role {i}": "Hips" for i in range(500)}, {"hips": ""}],
)
def test_roles_of_an_upload_are_bounded(idle: httpx2.Client, roles: dict[str, str]) -> None:
    files = {"file": ("a.bvh", b"HIERARCHY\nROOT Hips\n{")}
    answer = idle.post("/v1/clips", files=files, data={"roles": json.dumps(roles)})
    assert answer.status_code == 422
    assert len(answer.content) < 10_000


def test_a_failure_with_a_long_quote_is_shortened() -> None:
    places = [Place(LONG, LONG) for _ in range(1000)]
    problem = KinedexError(LONG, places=places).as_problem()
    assert len(problem["detail"]) == MAX_DETAIL
    assert len(problem["errors"]) == MAX_STORED_PLACES
    assert len(json.dumps(problem)) < 50_000


def test_labels_are_paged(demo: httpx2.Client) -> None:
    for path in ("/v1/persons", "/v1/tasks", "/v1/words"):
        every = demo.get(path).json()
        assert every["next"] is None
        first = demo.get(path, params={"limit": 1}).json()
        rest = demo.get(path, params={"limit": 1000, "cursor": first["next"]}).json()
        assert first["items"] + rest["items"] == every["items"]
        assert rest["next"] is None
    answer = demo.get("/v1/tasks", params={"cursor": "nonsense"})
    assert_problem(answer, 404, "page_not_found", "query.cursor")


def test_a_list_sorted_by_long_names_goes_on(idle_service: Live) -> None:
    with idle_service.client() as client:
        for number in range(3):
            files = {"file": ("a.bvh", f"HIERARCHY\nROOT {number}\n".encode())}
            client.post("/v1/clips", files=files, data={"name": "ж" * 299 + str(number)})
        asked = {"q": "жжж", "sort": "name", "limit": 2}
        page = client.get("/v1/clips", params=asked).json()
        rest = client.get("/v1/clips", params=asked | {"cursor": page["next"]}).json()
    assert (len(page["items"]), len(rest["items"])) == (2, 1)
