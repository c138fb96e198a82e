"""Bad input of every kind: a problem names its location at once, and never a 500."""

from __future__ import annotations

import io
import json
import socket
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest

from app.services.imports.manifest import Manifest
from app.services.imports.manifest_table import ManifestLimits
from tests.api.conftest import assert_problem
from tests.live import Live

SEARCH, WORDS, RECOGNIZE = "/v1/search/motion", "/v1/search/words", "/v1/recognize"


@pytest.mark.parametrize(
    ("content", "status", "code"),
    [
        (b"", 422, "empty_file"),
        (b"hello, this is no motion", 415, "unknown_format"),
        (bytes(range(256)) * 40, 415, "unknown_format"),
        (b"\x7fELF" + bytes(5000), 415, "unknown_format"),
    ],
    ids=["empty", "text", "binary", "program"],
)
@pytest.mark.parametrize("path", ["/v1/clips", SEARCH, RECOGNIZE])
def test_content_that_is_no_motion_is_refused(
    idle: httpx2.Client, path: str, content: bytes, status: int, code: str
) -> None:
    assert_problem(idle.post(path, files={"file": ("a.bvh", content)}), status, code)
    assert idle.get("/v1/clips", params={"q": "a.bvh", "state": "queued"}).json()["items"] == []


@pytest.mark.parametrize(
    ("data", "location"),
    [
        ({"frame_rate": "fast"}, "body.frame_rate"),
        ({"frame_rate": "-1"}, "body.frame_rate"),
        ({"frame_rate": "nan"}, "body.frame_rate"),
        ({"frame_rate": "inf"}, "body.frame_rate"),
        ({"frame_rate": "0.01"}, "body.frame_rate"),
        ({"frame_rate": "2001"}, "body.frame_rate"),
        ({"unit": "furlong"}, "body.unit"),
        ({"roles": "{"}, "body.roles"),
        ({"roles": "[]"}, "body.roles"),
        ({"roles": '{"tail": "Tail"}'}, "body.roles.tail"),
        ({"colour": "red"}, "body.colour"),
        ({"person": "x" * 301}, "body.person"),
        ({"person": "a\x00b"}, "body.person"),
        ({"words": " ".join(f"w{i}" for i in range(101))}, "body.words"),
    ],
)
def test_fields_of_an_upload(idle: httpx2.Client, data: dict[str, str], location: str) -> None:
    files = {"file": ("a.bvh", b"HIERARCHY\nROOT Hips\n{")}
    assert_problem(idle.post("/v1/clips", files=files, data=data), 422, "bad_field", location)


@pytest.mark.parametrize("rate", [0.01, 0.999, 2000.1])
def test_uploads_patches_and_manifests_refuse_the_same_frame_rates(
    idle: httpx2.Client, rate: float
) -> None:
    files, said = {"file": ("a.bvh", b"HIERARCHY\nROOT Hips\n{")}, {"frame_rate": str(rate)}
    answers = [idle.post(path, files=files, data=said) for path in ("/v1/clips", SEARCH, RECOGNIZE)]
    answers.append(idle.patch("/v1/clips/nope", json={"frame_rate": rate}))
    for answer in answers:
        assert_problem(answer, 422, "bad_field", "body.frame_rate")
    manifest = Manifest(ManifestLimits(10))
    manifest.read(io.BytesIO(f"path,fps\na.bvh,{rate}\n".encode()))
    row = manifest.row("a.bvh")
    assert row.problem is not None
    assert "from 1 to 2000 Hz" in row.problem.detail


def test_an_upload_without_its_file(idle: httpx2.Client) -> None:
    files = {"other": ("a.bvh", b"HIERARCHY")}
    assert_problem(idle.post("/v1/clips", files=files), 422, "bad_field", "body.other")
    parts = {"name": (None, "a")}
    assert_problem(idle.post("/v1/clips", files=parts), 422, "bad_field", "body.file")
    text = {"file": (None, "HIERARCHY")}
    assert_problem(idle.post("/v1/clips", files=text), 422, "bad_field", "body.file")
    not_chosen = {"file": ("", b"")}
    assert_problem(idle.post("/v1/clips", files=not_chosen), 422, "bad_field", "body.file")
    twice = [("file", ("a", b"HIERARCHY")), ("file", ("b", b"HIERARCHY"))]
    assert_problem(idle.post("/v1/clips", files=twice), 422, "bad_field", "body.file")


MULTIPART = {"Content-Type": "multipart/form-data; boundary=x"}


@pytest.mark.parametrize(
    ("body", "headers"),
    [
        (b"not a form at all", MULTIPART),
        (b"--x\r\nContent-Disposition: form-data\r\n\r\nno name\r\n--x--", MULTIPART),
        (b"--x\r\nContent-Disposition: form-data; name=file; filename=a\r\n\r\ncut of", MULTIPART),
        (b"--x", {"Content-Type": "multipart/form-data"}),
        (b"", MULTIPART),
    ],
    ids=["garbage", "nameless", "truncated", "no-boundary", "nothing"],
)
@pytest.mark.parametrize("path", ["/v1/clips", "/v1/imports", SEARCH])
def test_forms_that_cannot_be_read(
    idle: httpx2.Client, path: str, body: bytes, headers: dict[str, str]
) -> None:
    answer = idle.post(path, content=body, headers=headers)
    assert answer.status_code in {400, 422}
    assert_problem(answer, answer.status_code, answer.json()["code"])


def test_forms_with_too_much_in_them(idle: httpx2.Client) -> None:
    many = {f"f{i}": (None, "x") for i in range(100)}
    assert_problem(idle.post("/v1/clips", files=many), 400, "malformed_body")
    long = {"name": (None, "x" * 100_000)}
    assert_problem(idle.post("/v1/clips", files=long), 400, "malformed_body")


@pytest.mark.parametrize("path", [SEARCH, WORDS, RECOGNIZE])
@pytest.mark.parametrize(
    "body", [b"{", b"", b'{"clip_id": }', b"\xff\xfe", b"[" * 100_000], ids=repr
)
def test_json_that_cannot_be_read(idle: httpx2.Client, path: str, body: bytes) -> None:
    answer = idle.post(path, content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code in {400, 422}
    assert_problem(answer, answer.status_code, answer.json()["code"])


@pytest.mark.parametrize("path", ["/v1/clips", "/v1/imports", SEARCH, WORDS, RECOGNIZE])
def test_a_media_type_that_is_not_taken(idle: httpx2.Client, path: str) -> None:
    answer = idle.post(path, content=b"<a/>", headers={"Content-Type": "text/xml"})
    assert_problem(answer, 415, "unsupported_media_type")


@pytest.mark.parametrize(
    ("path", "body", "location"),
    [
        (SEARCH, {}, "body.clip_id"),
        (SEARCH, {"clip_id": "x", "limit": 0}, "body.limit"),
        (SEARCH, {"clip_id": "x", "limit": 1001}, "body.limit"),
        (SEARCH, {"clip_id": "x", "limit": "ten"}, "body.limit"),
        (SEARCH, {"clip_id": "x", "method": "magic"}, "body.method"),
        (SEARCH, {"clip_id": "x", "scope": "all"}, "body.scope"),
        (SEARCH, {"clip_id": "x", "colour": 1}, "body.colour"),
        (SEARCH, {"clip_id": "x", "filter": {"colour": "red"}}, "body.filter.colour"),
        (SEARCH, {"clip_id": "x", "filter": {"person": []}}, "body.filter.person"),
        (SEARCH, {"clip_id": "x", "filter": {"min_duration": "long"}}, "body.filter.min_duration"),
        (SEARCH, {"clip_id": "x", "start": -1}, "body.start"),
        (SEARCH, {"clip_id": "x", "start": float("nan")}, "body.start"),
        (SEARCH, {"clip_id": "x", "end": float("inf")}, "body.end"),
        (SEARCH, {"clip_id": 7}, "body.clip_id"),
        (WORDS, {"words": []}, "body.words"),
        (WORDS, {"words": "walk"}, "body.words"),
        (WORDS, {"words": ["walk"], "mode": "poetry"}, "body.mode"),
        (WORDS, {"words": ["walk"], "filter": {"q": "x"}}, "body.filter.q"),
        (RECOGNIZE, {}, "body.clip_id"),
        (RECOGNIZE, {"clip_id": "x", "known_taks": "walk"}, "body.known_taks"),
    ],
)
def test_fields_of_a_query(
    idle: httpx2.Client, path: str, body: dict[str, Any], location: str
) -> None:
    # json.dumps writes NaN and Infinity. The JSON encoders of strict clients refuse them.
    headers = {"Content-Type": "application/json"}
    answer = idle.post(path, content=json.dumps(body), headers=headers)
    assert_problem(answer, 422, "bad_field", location)


@pytest.mark.parametrize("typed", ["\0", "a\0b", "a\nb"])
@pytest.mark.parametrize("path", ["/v1/clips", "/v1/words"])
def test_control_characters_in_a_search_text_are_refused(
    idle: httpx2.Client, path: str, typed: str
) -> None:
    # SQLite's LIKE ends at a NUL: it would find every clip
    assert_problem(idle.get(path, params={"q": typed}), 422, "bad_field", "query.q")


def test_a_body_that_is_no_object(idle: httpx2.Client) -> None:
    for body in ("[]", '"x"', "null", "1"):
        headers = {"Content-Type": "application/json"}
        assert_problem(idle.post(SEARCH, content=body, headers=headers), 422, "bad_field")


def test_exactly_one_of_clip_id_and_file(idle: httpx2.Client) -> None:
    both = idle.post(SEARCH, files={"file": ("a", b"HIERARCHY")}, data={"clip_id": "x"})
    assert_problem(both, 422, "bad_field", "body.clip_id", "body.file")
    neither = idle.post(SEARCH, files={"limit": (None, "3")})
    assert_problem(neither, 422, "bad_field", "body.clip_id", "body.file")


def test_the_filter_of_a_form_is_json(idle: httpx2.Client) -> None:
    files = {"file": ("a", b"HIERARCHY")}
    for text, location in (("{", "body.filter"), ('{"colour": "red"}', "body.filter.colour")):
        answer = idle.post(SEARCH, files=files, data={"filter": text})
        assert_problem(answer, 422, "bad_field", location)


@pytest.mark.parametrize(
    ("path", "location"),
    [
        ("/v1/clips?limit=0", "query.limit"),
        ("/v1/clips?limit=1001", "query.limit"),
        ("/v1/clips?sort=colour", "query.sort"),
        ("/v1/clips?state=lost", "query.state"),
        ("/v1/clips?min_duration=nan", "query.min_duration"),
        ("/v1/clips?colour=red", "query.colour"),
        ("/v1/jobs?limit=-1", "query.limit"),
    ],
)
def test_queries(idle: httpx2.Client, path: str, location: str) -> None:
    assert_problem(idle.get(path), 422, "bad_field", location)


@pytest.mark.parametrize(
    "path", ["/v1/clips?cursor=zzz", "/v1/clips?cursor=%00", "/v1/jobs?cursor=e30"]
)
def test_a_page_that_no_list_has(idle: httpx2.Client, path: str) -> None:
    assert_problem(idle.get(path), 404, "page_not_found", "query.cursor")


@pytest.mark.parametrize(
    ("method", "path", "code"),
    [
        ("GET", "/v1/clips/nope", "clip_not_found"),
        ("GET", "/v1/clips/..%2f..%2fetc%2fpasswd/file", "not_found"),
        ("GET", "/v1/clips/%00/file", "clip_not_found"),
        ("DELETE", "/v1/clips/nope", "clip_not_found"),
        ("GET", "/v1/clips/nope/motion", "clip_not_found"),
        ("GET", "/v1/clips/nope/thumbnail.svg", "clip_not_found"),
        ("GET", "/v1/jobs/nope", "job_not_found"),
        ("GET", "/v1/jobs/nope/events", "job_not_found"),
        ("DELETE", "/v1/jobs/nope", "job_not_found"),
        ("GET", "/v1/nowhere", "not_found"),
        ("GET", "/static-offline-docs/..%2fcore.py", "not_found"),
    ],
)
def test_ids_and_paths_that_do_not_exist(
    idle: httpx2.Client, method: str, path: str, code: str
) -> None:
    assert_problem(idle.request(method, path), 404, code)


def test_the_problem_names_the_field_of_an_unknown_clip(idle: httpx2.Client) -> None:
    for path in (SEARCH, RECOGNIZE):
        for sent in ({"json": {"clip_id": "nope"}}, {"files": {"clip_id": (None, "nope")}}):
            answer = idle.post(path, **sent)
            assert_problem(answer, 404, "clip_not_found", "body.clip_id")
    patched = idle.patch("/v1/clips/nope", json={"name": "a"})
    assert_problem(patched, 404, "clip_not_found", "path.clip_id")
    assert_problem(idle.get("/v1/clips/nope/motion"), 404, "clip_not_found", "path.clip_id")


def test_the_problem_names_the_field_of_a_clip_that_is_not_ready(idle: httpx2.Client) -> None:
    files = {"file": ("a.bvh", b"HIERARCHY never analysed")}
    clip = idle.post("/v1/clips", files=files).json()["clip"]["id"]
    answer = idle.post(SEARCH, json={"clip_id": clip})
    assert_problem(answer, 409, "clip_not_ready", "body.clip_id")
    answer = idle.get(f"/v1/clips/{clip}/motion")
    assert_problem(answer, 409, "clip_not_ready", "path.clip_id")


def test_a_method_without_a_route_is_refused(idle: httpx2.Client) -> None:
    answer = idle.put("/v1/clips/x", json={})
    assert_problem(answer, 405, "method_not_allowed")
    assert "GET" in answer.headers["allow"]


def test_no_model_yet(idle: httpx2.Client) -> None:
    answer = idle.post(WORDS, json={"words": ["walk"]})
    assert_problem(answer, 409, "model_not_fitted")
    assert "retry-after" not in answer.headers
    assert "POST /v1/models/fit" in answer.json()["detail"]


def test_a_model_that_is_being_fitted_has_a_retry_after(idle: httpx2.Client) -> None:
    job = idle.post("/v1/models/fit").json()["job"]["id"]
    try:
        answer = idle.post(WORDS, json={"words": ["walk"]})
        assert_problem(answer, 409, "model_not_fitted")
        assert int(answer.headers["retry-after"]) > 0
        assert job in answer.json()["detail"]
    finally:
        assert idle.delete(f"/v1/jobs/{job}").status_code == 202


def test_a_file_over_the_limit(idle_service: Live) -> None:
    with idle_service.client() as client:
        for path in ("/v1/clips", SEARCH):
            files = {"file": ("too large.bvh", b"HIERARCHY\n" * 40_000)}
            assert_problem(client.post(path, files=files), 413, "too_large")
        assert client.get("/v1/clips", params={"q": "too large"}).json()["items"] == []
    assert _temporary_files(idle_service.data_dir) == []


def test_a_body_over_the_limit_is_refused_by_its_length(idle_service: Live) -> None:
    with idle_service.client() as client:
        files = {"file": ("a.bvh", b"x" * 3_000_000)}
        assert_problem(client.post("/v1/clips", files=files), 413, "too_large")
        answer = client.post(WORDS, content=b" " * 2_000_000)
        assert_problem(answer, 413, "too_large")


def test_a_body_over_the_limit_is_refused_while_it_streams(idle_service: Live) -> None:
    with idle_service.client() as client:
        for path in ("/v1/clips", WORDS):
            kind = "multipart/form-data; boundary=x" if path == "/v1/clips" else "application/json"
            head = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a"\r\n\r\n'
            chunks = (chunk for chunk in [head, *[b"y" * 100_000] * 40])
            answer = client.post(path, content=chunks, headers={"Content-Type": kind})
            assert_problem(answer, 413, "too_large")
    assert _temporary_files(idle_service.data_dir) == []


def test_a_client_with_expect_100_continue_need_not_send_the_body(idle_service: Live) -> None:
    address = urlsplit(idle_service.url)
    with socket.create_connection((address.hostname or "", address.port or 0), timeout=300) as line:
        line.sendall(
            b"POST /v1/clips HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data\r\n"
            b"Content-Length: 99999999999\r\nExpect: 100-continue\r\n\r\n"
        )
        assert line.recv(4096).startswith(b"HTTP/1.1 413")


def _temporary_files(data_dir: Path) -> list[Path]:
    return list((data_dir / "files" / "tmp").iterdir())
