"""`kinedex evaluate low-dimensional`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Kinedex

COMMAND = ("evaluate", "low-dimensional")
WAVES = ("--filter", '{"task": "wave"}')


def test_tables_for_people_fit_a_terminal(kinedex: Kinedex) -> None:
    ended = kinedex(*COMMAND, *WAVES)
    assert ended.code == 0, ended.err
    assert "K'  clips  kept k  kept u" in ended.out
    assert "Several persons in one model" in ended.out
    assert "…" not in ended.out


def test_json_for_programs(kinedex: Kinedex) -> None:
    result = kinedex(*COMMAND, *WAVES, "--json").json()
    assert result["clips"] == result["dimensions"][0]["clips"]
    assert set(result["dimensions"][0]["error_mm"]) == {"keypose", "uniform", "all_frames"}
    assert [row["basis"] for row in result["poses"]] == ["original", "keypose", "uniform"]
    assert [group["task"] for group in result["groups"]] == ["wave"]


@pytest.mark.slow
def test_pictures_are_written_to_the_given_paths(kinedex: Kinedex, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "pictures"
    ended = kinedex(*COMMAND, *WAVES, "--pictures", str(folder), "--picture-format", "png")
    assert ended.code == 0, ended.err
    assert (folder / "eigen-motion.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "dimensions.svg").is_file()


def test_wrong_options_are_refused(kinedex: Kinedex) -> None:
    ended = kinedex(*COMMAND, "--filter", '{"task": "sleep"}')
    assert ended.code != 0
    assert "No ready clip has 4 keyposes; 0 were looked at" in ended.err
    assert kinedex(*COMMAND, "--picture-format", "bmp").code != 0
