"""Two clips compared moment by moment, over HTTP."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from app.motion.roles.joint_roles import SUN_ROLES
from tests.api.conftest import assert_problem


@pytest.fixture
def wave(demo: httpx2.Client) -> dict[str, Any]:
    clip: dict[str, Any] = demo.get("/v1/clips", params={"task": "wave"}).json()["items"][0]
    return clip


def test_two_clips_are_aligned_step_by_step(
    demo: httpx2.Client, walk: dict[str, Any], wave: dict[str, Any]
) -> None:
    found = demo.get(f"/v1/clips/{walk['id']}/alignment", params={"other": wave["id"]}).json()
    assert found["joints"] == [role.value for role in SUN_ROLES]
    assert len(found["path"]) == len(found["differences"])
    assert {len(step) for step in found["differences"]} == {13}
    assert found["path"][0] == pytest.approx([0, 0], abs=0.5)  # active parts are aligned
    assert found["path"][-1] == pytest.approx([walk["duration"], wave["duration"]], abs=0.5)
    columns = zip(*found["differences"], strict=True)
    means = [sum(column) / len(found["path"]) for column in columns]
    assert found["mean_differences"] == pytest.approx(means, abs=1e-3)
    assert found["mean_differences"][found["joints"].index("hips")] == 0
    assert all(0.5 < length < 2 for length in found["body_lengths"])


def test_peaks_are_steps_of_the_path(
    demo: httpx2.Client, walk: dict[str, Any], wave: dict[str, Any]
) -> None:
    found = demo.get(f"/v1/clips/{walk['id']}/alignment", params={"other": wave["id"]}).json()
    assert 1 <= len(found["peaks"]) <= 5
    for peak in found["peaks"]:
        joints = found["differences"][found["path"].index(peak["times"])]
        assert peak["joint_difference"] == max(joints)
        assert peak["joint"] == found["joints"][joints.index(max(joints))]
        assert peak["difference"] == pytest.approx(sum(joints) / 13, abs=1e-3)
    greatest = [peak["difference"] for peak in found["peaks"]]
    assert greatest == sorted(greatest, reverse=True)


def test_parts_are_aligned_in_the_time_of_their_clips(
    demo: httpx2.Client, walk: dict[str, Any], wave: dict[str, Any]
) -> None:
    asked = {"other": wave["id"], "start": 1, "end": 2, "other_start": 0.5, "other_end": 1.5}
    path = demo.get(f"/v1/clips/{walk['id']}/alignment", params=asked).json()["path"]
    assert path[0] == pytest.approx([1, 0.5], abs=0.02)
    assert path[-1] == pytest.approx([2, 1.5], abs=0.15)


def test_wrong_calls_are_problems_that_name_their_field(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    path, other = f"/v1/clips/{walk['id']}/alignment", {"other": walk["id"]}
    assert_problem(demo.get(path), 422, "bad_field", "query.other")
    assert_problem(demo.get(path, params={"other": "none"}), 404, "clip_not_found", "query.other")
    unknown = demo.get("/v1/clips/none/alignment", params=other)
    assert_problem(unknown, 404, "clip_not_found", "path.clip_id")
    late = demo.get(path, params={**other, "other_start": 900})
    assert_problem(late, 422, "bad_field", "query.other_start")
    negative = demo.get(path, params={**other, "start": -1})
    assert_problem(negative, 422, "bad_field", "query.start")
