"""Exports over HTTP: attachments with safe names, problems for wrong fields."""

from __future__ import annotations

import csv
import io
from typing import Any
from urllib.parse import unquote

import httpx2
import numpy as np
import pytest

from app.formats.c3d.points import read_points
from app.formats.read import read_recording
from tests.api.conftest import assert_problem
from tests.formats.gltf.files import Glb
from tests.live import Live

TYPES = {
    "bvh": "application/octet-stream",
    "glb": "model/gltf-binary",
    "npz": "application/zip",
    "csv": "text/csv; charset=utf-8",
    "c3d": "application/octet-stream",
    "trc": "text/tab-separated-values; charset=utf-8",
}


@pytest.mark.parametrize("format", TYPES)
def test_each_format_is_an_attachment(
    demo: httpx2.Client, walk: dict[str, Any], format: str
) -> None:
    answer = demo.get(f"/v1/clips/{walk['id']}/export", params={"format": format})
    assert answer.status_code == 200
    assert answer.headers["content-type"] == TYPES[format]
    assert answer.headers["x-content-type-options"] == "nosniff"
    disposition = answer.headers["content-disposition"]
    assert disposition.startswith('attachment; filename="')
    assert unquote(disposition.rpartition("''")[2]) == f"{walk['name']}.{format}"
    if format in ("bvh", "npz"):
        recording = read_recording(answer.content)
        assert recording.positions.shape == (walk["frames"], walk["joints"], 3)
    elif format == "c3d":
        points = read_points(answer.content)
        assert points.positions.shape == (walk["frames"], walk["joints"], 3)
    elif format == "glb":
        assert len(Glb(answer.content).times()) == walk["frames"]
    else:
        head = 6 if format == "trc" else 1
        assert answer.text.count("\n") == walk["frames"] + head


@pytest.mark.parametrize(
    ("content", "column"),
    [
        ("positions", "time_s"),
        ("angles", "left_knee_flexion_deg"),
        ("segments", "duration_s"),
        ("gait", "symmetry_index_pct"),
        ("strides", "stride_length_m"),
        ("cycles", "knee_flexion_deg_mean"),
    ],
)
def test_each_table_is_a_csv_file(
    demo: httpx2.Client, walk: dict[str, Any], content: str, column: str
) -> None:
    params = {"format": "csv", "content": content}
    answer = demo.get(f"/v1/clips/{walk['id']}/export", params=params)
    assert answer.status_code == 200, answer.text
    head, *rows = csv.reader(io.StringIO(answer.text, newline=""))
    assert column in head
    assert rows
    assert {len(row) for row in rows} == {len(head)}


def test_a_clip_without_walking_has_no_gait(demo: httpx2.Client) -> None:
    (wave, *_) = demo.get("/v1/clips", params={"task": "wave"}).json()["items"]
    params = {"format": "csv", "content": "gait"}
    answer = demo.get(f"/v1/clips/{wave['id']}/export", params=params)
    assert_problem(answer, 422, "no_gait", "clip_id")
    assert "expected at least one stride" in answer.json()["detail"]


def test_every_column_is_described(demo: httpx2.Client) -> None:
    paths = demo.get("/openapi.json").json()["paths"]
    description = paths["/v1/clips/{clip_id}/export"]["get"]["description"]
    for name in ("hip_flexion_deg", "pelvis_obliquity_deg", "step_width_m", "cycle_pct"):
        assert name in description


def test_an_exported_file_can_be_uploaded(
    demo: httpx2.Client, demo_service: Live, walk: dict[str, Any]
) -> None:
    params = {"format": "npz", "skeleton": "canonical", "fps": 25}
    file = demo.get(f"/v1/clips/{walk['id']}/export", params=params)
    answer = demo.post("/v1/clips", files={"file": ("again.npz", file.content)}).json()
    try:
        assert demo_service.wait_for_job(answer["job"]["id"])["state"] == "succeeded"
        clip = demo.get(f"/v1/clips/{answer['clip']['id']}").json()
        assert (clip["state"], clip["format"]) == ("ready", "npz")
        assert (clip["frame_rate"], clip["joints"]) == (25, 18)
        assert clip["missing_roles"] == []
        assert clip["duration"] == pytest.approx(walk["duration"], abs=0.1)
    finally:
        demo.delete(f"/v1/clips/{answer['clip']['id']}")


def test_a_name_with_anything_in_it_does_no_harm(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    path = f"/v1/clips/{walk['id']}"
    demo.patch(path, json={"name": 'é"; evil=1\\../日本'})
    try:
        answer = demo.get(f"{path}/export", params={"format": "csv", "fps": 1})
    finally:
        demo.patch(path, json={"name": walk["name"]})
    plain, _, coded = answer.headers["content-disposition"].partition("; filename*=UTF-8''")
    assert plain == 'attachment; filename="___ evil_1_..___.csv"'
    assert unquote(coded) == "é__ evil_1_.._日本.csv"


@pytest.mark.parametrize(
    ("params", "location"),
    [
        ({}, "query.format"),
        ({"format": "fbx"}, "query.format"),
        ({"format": "bvh", "fps": "0"}, "query.fps"),
        ({"format": "bvh", "fps": "1001"}, "query.fps"),
        ({"format": "bvh", "skeleton": "mine"}, "query.skeleton"),
        ({"format": "bvh", "colour": "red"}, "query.colour"),
        ({"format": "bvh", "content": "angles"}, "query.content"),
        ({"format": "csv", "content": "forces"}, "query.content"),
        ({"format": "csv", "content": "gait", "fps": "30"}, "query.fps"),
        ({"format": "glb", "unit": "cm"}, "query.unit"),
    ],
)
def test_wrong_fields_are_named(
    demo: httpx2.Client, walk: dict[str, Any], params: dict[str, str], location: str
) -> None:
    answer = demo.get(f"/v1/clips/{walk['id']}/export", params=params)
    assert_problem(answer, 422, "bad_field", location)


def test_unknown_clips_and_clips_that_are_not_ready_are_refused(idle: httpx2.Client) -> None:
    content = b"HIERARCHY\nROOT a\n{\nexported too early\n"
    clip = idle.post("/v1/clips", files={"file": ("a.bvh", content)}).json()["clip"]
    params = {"format": "bvh"}
    early = idle.get(f"/v1/clips/{clip['id']}/export", params=params)
    assert_problem(early, 409, "clip_not_ready")
    assert_problem(idle.get("/v1/clips/none/export", params=params), 404, "clip_not_found")


def test_canonical_clips_share_their_bones(demo: httpx2.Client) -> None:
    items = demo.get("/v1/clips", params={"task": "kick"}).json()["items"][:2]
    offsets = []
    for clip in items:
        params = {"format": "bvh", "skeleton": "canonical"}
        answer = demo.get(f"/v1/clips/{clip['id']}/export", params=params)
        assert "-canonical.bvh" in answer.headers["content-disposition"]
        offsets.append(read_recording(answer.content).skeleton.offsets)
    np.testing.assert_array_equal(offsets[0], offsets[1])
