"""The audit log over HTTP: changes, exports and forgotten persons, and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip
from app.store.key_role import KeyRole
from tests.api.conftest import assert_problem
from tests.api.test_service import _make_keys
from tests.live import Live, serve

NAME = "Anna Example"


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, dict[KeyRole, str]]]:
    with serve(tmp_path_factory.mktemp("audited") / "data") as live:
        yield live, _make_keys(live.data_dir)


@pytest.fixture
def admin(locked: tuple[Live, dict[KeyRole, str]]) -> Iterator[httpx2.Client]:
    live, secrets = locked
    with live.client(headers={"X-API-Key": secrets[KeyRole.ADMIN]}) as client:
        yield client


def _log(admin: httpx2.Client, **filters: str) -> list[dict[str, Any]]:
    entries: list[dict[str, Any]] = admin.get("/v1/audit", params=filters).json()["items"]
    return entries


def test_changes_and_exports_are_recorded_with_key_and_address(
    admin: httpx2.Client, locked: tuple[Live, dict[KeyRole, str]], take: DemoClip
) -> None:
    live, secrets = locked
    with live.client(headers={"X-API-Key": secrets[KeyRole.WRITE]}) as client:
        labels = {"person": NAME, "name": f"{NAME} walks", "path": f"{NAME}/walk.bvh"}
        files = {"file": (f"{NAME}.bvh", take.content)}
        made = client.post("/v1/clips", files=files, data=labels).json()
        clip_id = made["clip"]["id"]
        client.patch(f"/v1/clips/{clip_id}", json={"task": "walk", "words": [NAME]})
        for path in ("/v1/clips", f"/v1/clips/{clip_id}", "/v1/persons"):
            assert client.get(path).status_code == 200
        file = client.get(f"/v1/clips/{clip_id}/file")
        again = {"If-None-Match": file.headers["etag"]}
        assert client.get(f"/v1/clips/{clip_id}/file", headers=again).status_code == 304
        assert client.get("/v1/clips/nothing/file").status_code == 404
        manifest = client.get("/v1/manifest.csv", params={"person": NAME})
        assert NAME in manifest.text
        assert client.delete(f"/v1/persons/{NAME}").status_code == 204
        assert client.delete("/v1/clips/nothing").status_code == 404
        assert client.delete(f"/v1/clips/{clip_id}").status_code == 204
    entries = _log(admin)
    assert [entry["action"] for entry in reversed(entries)] == [
        "create_clip",
        "update_clip",
        "get_file",
        "get_manifest",
        "forget_person",
        "delete_clip",
    ]
    key_id = secrets[KeyRole.WRITE].split("_")[1]
    who = {(entry["key_id"], entry["key_name"], entry["address"]) for entry in entries}
    assert who == {(key_id, "write", "127.0.0.1")}
    by_action = {entry["action"]: entry for entry in entries}
    assert by_action["create_clip"]["details"] == {"job_id": made["job"]["id"]}
    assert by_action["update_clip"]["details"]["fields"] == ["task", "words"]
    assert by_action["forget_person"]["details"]["clips"] == 1
    of_clip = {entry["action"] for entry in _log(admin, clip=clip_id)}
    assert of_clip == {"create_clip", "update_clip", "get_file", "delete_clip"}
    assert [e["action"] for e in _log(admin, action="delete_clip", key=key_id)] == ["delete_clip"]
    assert _log(admin, since="2100-01-01T00:00:00Z") == []
    assert NAME.split()[0].casefold() not in str(entries).casefold()


def test_a_call_that_is_repeated_by_its_key_is_recorded_once(admin: httpx2.Client) -> None:
    headers = {"Idempotency-Key": "once"}
    answers = [admin.post("/v1/models/fit", headers=headers) for _ in range(2)]
    assert answers[0].json() == answers[1].json()
    (entry,) = _log(admin, action="request_fit")
    assert entry["details"] == {"job_id": answers[0].json()["job"]["id"]}


def test_the_log_needs_the_role_admin(locked: tuple[Live, dict[KeyRole, str]]) -> None:
    live, secrets = locked
    with live.client(headers={"X-API-Key": secrets[KeyRole.WRITE]}) as client:
        assert_problem(client.get("/v1/audit"), 403, "forbidden")
    with live.client(headers={"X-API-Key": secrets[KeyRole.ADMIN]}) as client:
        for wrong in ("yesterday", "0.5"):
            answer = client.get("/v1/audit", params={"since": wrong})
            assert_problem(answer, 422, "bad_field", "query.since")
        for since in ("0001-01-01T00:00:00+23:00", "9999-12-31T23:59:59-23:00"):
            assert client.get("/v1/audit", params={"since": since}).status_code == 200


def test_without_keys_the_address_is_recorded(idle: httpx2.Client) -> None:
    idle.post("/v1/models/fit")
    entry = _log(idle, action="request_fit")[0]
    assert (entry["key_id"], entry["address"]) == (None, "127.0.0.1")
