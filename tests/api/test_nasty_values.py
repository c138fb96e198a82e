"""Values that break careless programs, in every field of every call: the answer is never a 5xx.

Schemathesis (`test_fuzz`) mostly sends values that the description allows. Here every value is
unusual, and the library has clips and models, so that calls run deep into the code.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

import httpx2
import pytest

from app.api.app import create_app
from app.config import Settings
from tests.live import Live

NUMBERS = ["0", "-1", "1", "1e300", "-1e300", "1e-300", "1e400", "9" * 400, "NaN", "Infinity"]
NUMBERS += ["-0.0", "0x10", "1_0", "١", "9007199254740993", "2147483648", "9223372036854775808"]
TEXTS = ["", " ", "\0", "\ud800", "\U0010ffff", "%", "%00", "a" * 999, "'", '"', "[]", "{}", "null"]
TEXTS += ["true", "[" * 900, "../..", "-", "*", "kx_", "ǅ", "\u202e", "1,2", "2026-01-01T00:00:00Z"]
VALUES = NUMBERS + TEXTS
JSON_VALUES = [*(10**400, -1, 0, 1e300, 1e-300, 2**63, True, None), [], {}, [[]], [None], [10**400]]
JSON_VALUES += ["", "\0", "\ud800", "x" * 999, ["\ud800"], [""] * 3, {"a": {}}, [1e300] * 3]
LEFT_OUT = {"fps"}
"""Parameters that other tests cover."""
SPEC: dict[str, Any] = create_app(Settings()).openapi()


def operations(*methods: str) -> list[tuple[str, str]]:
    return [
        (path, method)
        for path, item in SPEC["paths"].items()
        for method in item
        if method in methods and not path.endswith("/events")
    ]


@pytest.fixture(scope="module")
def ids(demo_service: Live) -> dict[str, str]:
    """Values of the path parameters."""
    with demo_service.client() as client:
        clip = client.get("/v1/clips", params={"limit": 1}).json()["items"][0]["id"]
        job = client.get("/v1/jobs", params={"limit": 1}).json()["items"][0]["id"]
    return {"clip_id": clip, "job_id": job}


def filled(path: str, ids: dict[str, str], **others: str) -> str:
    for name, value in ({**ids, **others}).items():
        path = path.replace("{" + name + "}", value)
    return path.replace("{name}", "nobody").replace("{", "").replace("}", "")


def encoded(value: str) -> str:
    return quote(value.encode("utf-8", "surrogatepass"), safe="")


def check(answer: httpx2.Response, *sent: object) -> None:
    assert answer.status_code < 500, (*sent, answer.text[:500])


@pytest.mark.parametrize(("path", "method"), operations("get"))
def test_query_parameters(demo: httpx2.Client, ids: dict[str, str], path: str, method: str) -> None:
    for parameter in SPEC["paths"][path][method].get("parameters", []):
        if parameter["in"] != "query" or parameter["name"] in LEFT_OUT:
            continue
        for value in VALUES:
            url = f"{filled(path, ids)}?{parameter['name']}={encoded(value)}"
            check(demo.get(url), url)


@pytest.mark.parametrize(("path", "method"), operations("get", "delete"))
def test_path_parameters(idle: httpx2.Client, path: str, method: str) -> None:
    names = [name for name in ("clip_id", "job_id", "name", "model_id") if "{" + name in path]
    for name in names:
        for value in filter(None, TEXTS):
            url = filled(path, {}, **{name: encoded(value)})
            check(idle.request(method.upper(), url), url)


def _bodies(schema: dict[str, Any], base: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for name in schema.get("properties", {}):
        for value in JSON_VALUES:
            yield {**base, name: value}
            yield {name: value}


@pytest.mark.parametrize(("path", "method"), operations("post", "put", "patch"))
def test_json_bodies(idle: httpx2.Client, path: str, method: str) -> None:
    content = SPEC["paths"][path][method].get("requestBody", {}).get("content", {})
    if "application/json" not in content:
        return
    schema = content["application/json"]["schema"]
    name = schema.get("$ref", schema.get("anyOf", [{}])[0].get("$ref", "")).rsplit("/", 1)[-1]
    whole = SPEC["components"]["schemas"].get(name, {})
    base = whole.get("examples", [{}])[0]
    base = {key: "nope" if value == "CLIP_ID" else value for key, value in base.items()}
    headers = {"Content-Type": "application/json"}
    for body in _bodies(whole, base):
        url = filled(path, {"clip_id": "nope", "job_id": "nope"})
        check(idle.request(method.upper(), url, content=json.dumps(body), headers=headers), body)


SEARCHES: list[tuple[str, dict[str, Any]]] = [
    ("/v1/search/motion", {"method": "fused"}),
    ("/v1/search/motion", {"method": "dtw"}),
    ("/v1/search/motion", {"method": "vector", "scope": "windows", "start": 0.5, "end": 1.5}),
    ("/v1/search/motion", {"method": "vector", "scope": "segments", "segment": 0}),
    ("/v1/search/pose", {"time": 0.5}),
    ("/v1/search/words", {"words": ["walk"]}),
    ("/v1/search", {"words": ["walk"], "examples": [{"clip_id": "CLIP_ID"}], "method": "fused"}),
    ("/v1/search", {"words": ["walk"], "examples": [{"clip_id": "CLIP_ID"}], "method": "dtw"}),
]


@pytest.mark.parametrize(("path", "asked"), SEARCHES, ids=str)
def test_forged_cursors(
    demo: httpx2.Client, ids: dict[str, str], path: str, asked: dict[str, Any]
) -> None:
    body = {**asked, "limit": 1}
    if "examples" in asked:
        body["examples"] = [{"clip_id": ids["clip_id"]}]
    elif "words" not in path:
        body["clip_id"] = ids["clip_id"]
    answer = demo.post(path, json=body)
    if answer.status_code != 200 or answer.json()["next"] is None:
        return
    given = answer.json()["next"]
    decoded = json.loads(base64.urlsafe_b64decode(given + "=" * (-len(given) % 4)))
    for index in range(len(decoded)):
        for value in [*JSON_VALUES, -1e308, 1e308, 10**9]:
            forged = [*decoded[:index], value, *decoded[index + 1 :]]
            cursor = base64.urlsafe_b64encode(json.dumps(forged).encode()).decode().rstrip("=")
            check(demo.post(path, json={**body, "cursor": cursor}), forged)


def test_lists_survive_forged_cursors(demo: httpx2.Client) -> None:
    for path in ("/v1/clips", "/v1/jobs", "/v1/clips?sort=duration", "/v1/clips?sort=name"):
        for value in JSON_VALUES:
            for sort in ("created_at", "-created_at", "duration", "name"):
                held = json.dumps([sort, value, "clip"]).encode()
                cursor = base64.urlsafe_b64encode(held).decode()
                url = f"{path}{'&' if '?' in path else '?'}cursor={cursor}"
                check(demo.get(url), url)
