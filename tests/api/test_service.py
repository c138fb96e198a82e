"""The service apart from its calls: docs, health, headers, keys, logs, description."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import jsonschema
import pytest

from app.config import load_settings
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from tests import databases
from tests.api.conftest import assert_problem
from tests.live import NET_S, Live, serve, wait_until

METHODS = {"get", "post", "put", "patch", "delete"}


def test_health(idle: httpx2.Client) -> None:
    assert idle.get("/livez").json() == {"status": "alive"}
    assert idle.get("/readyz").json()["status"] == "ready"


def test_docs_load_nothing_from_elsewhere(idle: httpx2.Client) -> None:
    page = idle.get("/docs")
    policy = page.headers["content-security-policy"]
    assert "unsafe-inline" not in policy
    assert "sha256-" in policy
    assert "http://" not in page.text
    assert "https://" not in page.text
    for part in page.text.split('"'):
        if part.startswith("/static"):
            assert idle.get(part).status_code == 200


def test_metrics_count_requests(idle: httpx2.Client) -> None:
    idle.get("/v1/clips/nope")
    assert 'handler="/v1/clips/{clip_id}"' in idle.get("/metrics").text


@pytest.mark.parametrize(
    "path", ["/", "/livez", "/v1/clips", "/v1/nowhere", "/docs", "/openapi.json"]
)
def test_headers_of_every_answer(idle: httpx2.Client, path: str) -> None:
    headers = idle.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert "unsafe-inline" not in headers["content-security-policy"]
    assert "default-src 'none'" in headers["content-security-policy"]
    assert headers["x-request-id"]
    assert "server" not in headers


def test_request_ids_are_repeated_and_logged(idle_service: Live) -> None:
    with idle_service.client() as client:
        answer = client.get("/v1/clips?q=secret-name", headers={"X-Request-Id": "my-id.1"})
        assert answer.headers["x-request-id"] == "my-id.1"
        forged = client.get("/livez", headers={"X-Request-Id": 'a"b c'})
        assert forged.headers["x-request-id"] != 'a"b c'
    text = idle_service.log.read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    (line,) = [line for line in lines if line.get("request_id") == "my-id.1"]
    assert (line["method"], line["path"], line["status"]) == ("GET", "/v1/clips", 200)
    assert "secret-name" not in text


def test_the_description_is_complete(idle: httpx2.Client) -> None:
    description = idle.get("/openapi.json").json()
    operations = [
        (path, method, operation)
        for path, item in description["paths"].items()
        for method, operation in item.items()
        if method in METHODS
    ]
    assert len({operation["operationId"] for *_, operation in operations}) == len(operations)
    for path, method, operation in operations:
        if path.startswith("/v1"):
            assert operation["description"], (method, path)
            problem = operation["responses"]["422"]["content"]["application/problem+json"]
            assert problem["schema"]["$ref"].endswith("/Problem")
    for reference in _references(description):
        assert reference.rsplit("/", 1)[1] in description["components"]["schemas"]


def test_every_content_has_a_schema_and_no_member_of_later_versions(idle: httpx2.Client) -> None:
    """Generated clients lose an answer without a schema; openapi-generator refuses `itemSchema`."""
    for path, item in idle.get("/openapi.json").json()["paths"].items():
        for operation in item.values():
            for answer in operation["responses"].values():
                for content in answer.get("content", {}).values():
                    assert content["schema"], path
                    assert content.keys() <= {"schema", "example", "examples"}, path


def test_a_call_with_two_bodies_has_an_optional_parameter(idle: httpx2.Client) -> None:
    """Otherwise openapi-python-client 0.29.1 does not import `Unset` into the call's module.

    It cannot be a dependency of the tests: it needs an older typer than ours.
    """
    two_bodies = {
        path: operation.get("parameters", [])
        for path, item in idle.get("/openapi.json").json()["paths"].items()
        for operation in item.values()
        if len(operation.get("requestBody", {}).get("content", {})) > 1
    }
    assert set(two_bodies) == {
        "/v1/search",
        "/v1/search/motion",
        "/v1/search/pose",
        "/v1/search/why",
        "/v1/recognize",
    }
    for parameters in two_bodies.values():
        assert ("X-Request-Id", False) in [(one["name"], one["required"]) for one in parameters]


def test_the_examples_fit_their_schemas(idle: httpx2.Client) -> None:
    description = idle.get("/openapi.json").json()
    checked = 0
    for schema, example in _examples(description):
        whole = {**schema, "components": description["components"]}
        jsonschema.Draft202012Validator(whole).validate(example)
        checked += 1
    assert checked >= 8


def test_the_examples_can_be_run(demo: httpx2.Client) -> None:
    description = demo.get("/openapi.json").json()
    for path in ("/v1/search/motion", "/v1/search/words", "/v1/recognize"):
        content = description["paths"][path]["post"]["requestBody"]["content"]["application/json"]
        bodies = [e["value"] for e in content.get("examples", {}).values()]
        reference = content["schema"]["$ref"].rsplit("/", 1)[1]
        bodies += description["components"]["schemas"][reference].get("examples", [])
        assert bodies
        for body in bodies:
            answer = demo.post(path, json=body)
            assert answer.status_code == 200, (path, body, answer.text)


def _references(description: Any) -> Iterator[str]:
    if isinstance(description, dict):
        if isinstance(description.get("$ref"), str):
            yield description["$ref"]
        for value in description.values():
            yield from _references(value)
    elif isinstance(description, list):
        for value in description:
            yield from _references(value)


def _examples(description: dict[str, Any]) -> Iterator[tuple[dict[str, Any], Any]]:
    for schema in description["components"]["schemas"].values():
        for owner in (schema, *schema.get("properties", {}).values()):
            for example in owner.get("examples", []):
                yield owner, example
    for item in description["paths"].values():
        for operation in item.values():
            for content in operation.get("requestBody", {}).get("content", {}).values():
                for example in content.get("examples", {}).values():
                    yield content["schema"], example["value"]


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, dict[KeyRole, str]]]:
    """A service with a key of each role."""
    with serve(tmp_path_factory.mktemp("locked") / "data") as live:
        yield live, _make_keys(live.data_dir)


def _make_keys(data_dir: Path) -> dict[KeyRole, str]:
    settings = load_settings(data_dir=data_dir, database_url=databases.url_for(data_dir))
    store = Store.open(settings.database, settings.files_dir)
    with store.write() as tx:
        made = {role: keys.create(tx, role, role.value).secret for role in KeyRole}
    store.close()
    return made


def test_if_keys_exist_every_call_needs_one(locked: tuple[Live, dict[KeyRole, str]]) -> None:
    live, secrets = locked
    with live.client() as client:
        for path in ("/livez", "/readyz", "/docs", "/openapi.json"):
            assert client.get(path).status_code == 200
        for path in ("/v1/clips", "/v1/clips/x/file", "/v1/models", "/metrics"):
            answer = client.get(path)
            assert_problem(answer, 401, "unauthorized")
            assert answer.headers["www-authenticate"] == "Bearer"
        wrong = secrets[KeyRole.READ][:-1] + "x"
        assert_problem(client.get("/v1/clips", headers={"X-API-Key": wrong}), 401, "unauthorized")
    assert not any(secret in live.log.read_text() for secret in secrets.values())


def test_the_log_names_the_client_and_the_key(locked: tuple[Live, dict[KeyRole, str]]) -> None:
    live, secrets = locked
    secret = secrets[KeyRole.WRITE]
    with live.client(headers={"X-API-Key": secret}) as client:
        found = client.get("/v1/clips/named-in-the-log")
        assert_problem(found, 404, "clip_not_found")

    def logged() -> list[dict[str, Any]]:  # the line is written after the answer was sent
        lines = [json.loads(line) for line in live.log.read_text().splitlines()]
        return [line for line in lines if line.get("path") == "/v1/clips/named-in-the-log"]

    (line,) = wait_until(logged, NET_S)
    assert (line["client"], line["key_id"]) == ("127.0.0.1", secret.split("_")[1])


def test_roles_allow_what_they_say(locked: tuple[Live, dict[KeyRole, str]]) -> None:
    live, secrets = locked
    for role in KeyRole:
        for headers in (
            {"X-API-Key": secrets[role]},
            {"Authorization": f"Bearer {secrets[role]}"},
        ):
            with live.client(headers=headers) as client:
                assert client.get("/v1/clips").status_code == 200
                answer = client.delete("/v1/clips/nope")
                expected = (403, "forbidden") if role is KeyRole.READ else (404, "clip_not_found")
                assert_problem(answer, *expected)


def test_the_key_is_checked_before_the_body_is_read(
    locked: tuple[Live, dict[KeyRole, str]],
) -> None:
    live, _ = locked
    with live.client() as client:
        answer = client.post("/v1/clips", files={"file": ("a", b"")})
        assert_problem(answer, 401, "unauthorized")


def test_a_foreign_host_name_is_refused(idle: httpx2.Client) -> None:
    refused = idle.get("/v1/clips", headers={"Host": "rebound.example"})
    assert refused.status_code == 403
    assert idle.get("/v1/clips", headers={"Host": "localhost:1234"}).status_code == 200


def test_another_site_cannot_use_an_open_service(idle: httpx2.Client) -> None:
    evil = {"Origin": "http://evil.example"}
    answer = idle.post("/v1/models/fit", headers=evil)
    assert_problem(answer, 403, "forbidden")
    own = {"Origin": str(idle.base_url).rstrip("/")}
    assert idle.delete("/v1/clips/nope", headers=own).status_code == 404
