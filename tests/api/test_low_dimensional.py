"""Low-dimensional motions and animated pictures, over HTTP and in a browser."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import pytest

from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from tests.api.conftest import assert_problem
from tests.bodies import standing
from tests.formats.npz.files import npz
from tests.live import Live

NAMES = np.array([role.value for role in SUN_ROLES])
PARENTS = np.array(SUN_PARENTS)


@pytest.fixture
def wave(demo: httpx2.Client) -> dict[str, Any]:
    clip: dict[str, Any] = demo.get("/v1/clips", params={"task": "wave"}).json()["items"][0]
    return clip


def test_the_answer_has_motion_model_and_errors(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    path = f"/v1/clips/{wave['id']}/low-dimensional"
    reply = demo.get(path, params={"dimensions": 2}).json()
    frames = len(reply["positions"])
    assert (reply["basis"], reply["dimensions"], reply["frame_rate"]) == ("keypose", 2, 30)
    assert np.array(reply["positions"]).shape == (frames, 13, 3)
    assert np.array(reply["eigen_motion"]).shape == (frames, 3)
    assert len(reply["variance_kept"]) == len(reply["error"]) == reply["poses"]
    assert reply["variance_kept"][-1] == pytest.approx(1)
    assert [set(pose) for pose in reply["eigen_poses"]] == [{"clip_id", "time", "point"}] * reply[
        "poses"
    ]
    at = round(reply["eigen_poses"][0]["time"] * 30)
    assert reply["eigen_motion"][at] == pytest.approx(reply["eigen_poses"][0]["point"], abs=1e-5)
    assert reply["implausible"]["frames"] >= len(reply["implausible"]["faults"])


def test_octets_hold_the_same_positions(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    path = f"/v1/clips/{wave['id']}/low-dimensional"
    params = {"basis": "uniform", "poses": "6", "fps": "20"}
    reply = demo.get(path, params=params).json()
    answer = demo.get(path, params=params, headers={"Accept": "application/octet-stream"})
    shape = [int(size) for size in answer.headers["x-shape"].split(",")]
    assert answer.headers["x-frame-rate"] == "20"
    octets = np.frombuffer(answer.content, "<f4").reshape(shape)
    assert np.abs(octets - np.array(reply["positions"])).max() < 1e-5


def test_models_of_other_clips(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    waves = demo.get("/v1/clips", params={"task": "wave"}).json()["items"]
    ids = ",".join(clip["id"] for clip in waves)
    path = f"/v1/clips/{wave['id']}/low-dimensional"
    reply = demo.get(path, params={"model_clips": ids, "dimensions": 9}).json()
    assert {pose["clip_id"] for pose in reply["eigen_poses"]} == {clip["id"] for clip in waves}


@pytest.mark.parametrize(
    ("params", "location"),
    [
        ({"dimensions": "0"}, "query.dimensions"),
        ({"dimensions": "500"}, "query.dimensions"),
        ({"basis": "pca"}, "query.basis"),
        ({"poses": "5"}, "query.poses"),
        ({"fps": "-1"}, "query.fps"),
        ({"tea": "1"}, "query.tea"),
    ],
)
def test_wrong_fields_are_named(
    demo: httpx2.Client, wave: dict[str, Any], params: dict[str, str], location: str
) -> None:
    answer = demo.get(f"/v1/clips/{wave['id']}/low-dimensional", params=params)
    assert_problem(answer, 422, "bad_field", location)


def test_a_still_clip_has_too_few_keyposes(demo: httpx2.Client, demo_service: Live) -> None:
    file = npz(
        positions=standing(60), frame_rate=30.0, unit="m", joint_names=NAMES, parents=PARENTS
    )
    answer = demo.post("/v1/clips", files={"file": ("still.npz", file)}).json()
    path = f"/v1/clips/{answer['clip']['id']}"
    try:
        assert demo_service.wait_for_job(answer["job"]["id"])["state"] == "succeeded"
        for basis in ("keypose", "uniform"):
            refused = demo.get(f"{path}/low-dimensional", params={"basis": basis})
            assert_problem(refused, 409, "not_enough_keyposes", "query.model_clips")
            assert "at least 2 poses; found 0" in refused.json()["detail"]
        params = {"basis": "uniform", "poses": 5}
        reply = demo.get(f"{path}/low-dimensional", params=params).json()
        assert reply["variance_kept"] == [1.0] * 5
        assert max(reply["error"]) < 1e-5
    finally:
        demo.delete(path)


def test_unknown_clips_are_not_found(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    assert_problem(demo.get("/v1/clips/none/low-dimensional"), 404, "clip_not_found")
    assert_problem(demo.get("/v1/clips/none/animation.svg"), 404, "clip_not_found")
    params = {"model_clips": f"{wave['id']},none"}
    answer = demo.get(f"/v1/clips/{wave['id']}/low-dimensional", params=params)
    assert_problem(answer, 404, "clip_not_found", "query.model_clips.1")


@pytest.mark.parametrize("path", ["animation.svg", "export?format=csv"])
def test_other_reduction_fields_need_dimensions(
    demo: httpx2.Client, wave: dict[str, Any], path: str
) -> None:
    sign = "&" if "?" in path else "?"
    answer = demo.get(f"/v1/clips/{wave['id']}/{path}{sign}basis=uniform")
    assert_problem(answer, 422, "bad_field", "query.dimensions")


def test_exports_can_be_low_dimensional(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    path = f"/v1/clips/{wave['id']}/export"
    answer = demo.get(path, params={"format": "csv", "dimensions": 2, "basis": "uniform"})
    assert answer.status_code == 200
    assert "-uniform-2dim.csv" in answer.headers["content-disposition"]
    assert answer.text.splitlines()[0].count(",") == 39


@pytest.mark.slow
def test_the_picture_moves_in_a_browser_under_our_policy(
    demo_service: Live, demo: httpx2.Client, wave: dict[str, Any], tmp_path: Path
) -> None:
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("NO BROWSER: install chromium to see that pictures move")
    path = f"/v1/clips/{wave['id']}/animation.svg?dimensions=2"
    answer = demo.get(path)
    assert answer.headers["content-type"] == "image/svg+xml"
    assert answer.headers["content-security-policy"].startswith("default-src 'none'")
    seen = [
        _shot(browser, demo_service.url + path, ms, tmp_path / f"{ms}.png") for ms in (700, 1700)
    ]
    assert seen[0] != seen[1]
    still = f"{demo_service.url}/v1/clips/{wave['id']}/animation.svg?start=1&end=1.03"
    shots = [_shot(browser, still, ms, tmp_path / f"still{ms}.png") for ms in (700, 1700)]
    assert shots[0] == shots[1], "a picture of one frame does not move"


def _shot(browser: str, url: str, milliseconds: int, target: Path) -> bytes:
    """A screenshot of a browser, in its virtual time after it opened the page."""
    subprocess.run(
        [
            browser, "--headless", "--no-sandbox", "--no-proxy-server", "--disable-gpu",
            "--hide-scrollbars", f"--user-data-dir={target.parent / 'profile'}",
            "--window-size=360,300", f"--virtual-time-budget={milliseconds}",
            f"--screenshot={target}", url,
        ],
        check=True, timeout=300, capture_output=True,
    )  # fmt: skip
    return target.read_bytes()
