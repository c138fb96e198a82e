"""`kinedex search-pose`."""

from __future__ import annotations

import json
from pathlib import Path

from app.api.schemas.pose import A_POSE, PoseHits
from tests.cli.conftest import Kinedex


def test_a_file_finds_its_pose_at_its_time(kinedex: Kinedex, folder: Path) -> None:
    file = str(folder / "ada" / "kick_01.bvh")
    asked = ("search-pose", file, "--time", "0.8", "--limit", "3", "--json")
    found = kinedex(*asked, "--include-self").json()
    assert PoseHits.model_validate(found).model_dump(mode="json") == found
    first = found["items"][0]
    assert (first["clip"]["name"], first["clip"]["person"]) == ("kick_01", "ada")
    assert abs(first["time"] - 0.8) < 0.02
    again = kinedex("search-pose", first["clip"]["id"], "--time", "0.8", "--json").json()
    assert again["items"][0]["clip"]["id"] == found["items"][1]["clip"]["id"]
    without_it = kinedex(*asked).json()["items"]
    assert [hit["clip"]["id"] for hit in without_it[:2]] == [
        hit["clip"]["id"] for hit in again["items"][:2]
    ]


def test_positions_of_a_file_and_a_table(kinedex: Kinedex, tmp_path: Path) -> None:
    pose = tmp_path / "pose.json"
    pose.write_text(json.dumps(A_POSE))
    asked = ("search-pose", "--positions", str(pose), "--limit", "2")
    found = kinedex(*asked, "--filter", '{"task": "wave"}', "--places", "all", "--json").json()
    assert {hit["clip"]["task"] for hit in found["items"]} == {"wave"}
    lines = kinedex(*asked).out.splitlines()
    assert lines[0].split() == ["rank", "score", "time", "name", "person", "task", "id"]
    assert len(lines) == 3


def test_wrong_queries_are_refused(kinedex: Kinedex, folder: Path, tmp_path: Path) -> None:
    file = str(folder / "ada" / "kick_01.bvh")
    assert kinedex("search-pose").code == 2
    assert kinedex("search-pose", file).code == 2
    assert kinedex("search-pose", file, "--positions", file).code == 2
    late = kinedex("search-pose", file, "--time", "99")
    assert late.code == 1
    assert "time: must be from 0 to the duration" in late.err
    pose = tmp_path / "pose.json"
    for text, expected in (
        ("{", "positions: "),
        ("{}", "positions: "),
        ("[[0, 0, 0]]", "expected 13 points"),
        (json.dumps([["x", 0, 0], *A_POSE[1:]]), "positions.0: left_knee: "),
    ):
        pose.write_text(text)
        ended = kinedex("search-pose", "--positions", str(pose))
        assert ended.code == 1
        assert expected in ended.err
