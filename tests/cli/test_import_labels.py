"""`kinedex import` with labels: options, patterns, corrections, what is printed, exit codes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from app.demo import demo_clips
from tests.cli.conftest import Ended, Kinedex


@pytest.fixture
def mocap(tmp_path: Path) -> Path:
    """A folder with two clips and a note."""
    folder = tmp_path / "mocap"
    for number, clip in enumerate(demo_clips(["elin"], ["walk"], takes=2), 1):
        path = folder / "elin" / "walk" / f"{number:02d}.bvh"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(clip.content)
    (folder / "notes.txt").write_text("buy milk")
    return folder


def _files(ended: Ended) -> dict[str, dict[str, Any]]:
    return {file["path"]: file for file in json.loads(ended.out)["result"]["files"]}


def test_labels_from_options_and_paths_are_applied_again_after_a_correction(
    kinedex_alone: Kinedex, mocap: Path
) -> None:
    words = ("--labels", "{person}/{task}/{take}.bvh", "--license", "CC0", "--meta", "site=lab 2")
    first = kinedex_alone("import", str(mocap), *words, "--meta", "age=30")
    assert first.code == 0, first.err
    assert "3 files: 2 new, 0 updated, 0 unchanged, 1 skipped." in first.out
    assert "Skipped, because they are no motions: notes.txt" in first.out

    corrected = ("--labels", "{person}/{task}/{take}.bvh", "--meta", "age=31", "--words", "slow")
    again = kinedex_alone("import", str(mocap), *corrected, "--json")
    differences = _files(again)["elin/walk/01.bvh"]["differences"]
    assert differences == [
        {"field": "meta.age", "stored": 30, "sent": 31, "applied": True},
        {"field": "words", "stored": None, "sent": ["slow"], "applied": True},
    ]
    printed = kinedex_alone("import", str(mocap), "--person", "anna").out
    assert "2 updated" in printed
    assert [line.split() for line in printed.splitlines() if line.startswith("elin/walk/01")] == [
        ["elin/walk/01.bvh", "person", "elin", "anna"]
    ]
    same = kinedex_alone("import", str(mocap), "--person", "anna").out
    assert "3 files: 0 new, 0 updated, 2 unchanged, 1 skipped." in same


def test_the_exit_code_says_whether_files_failed_or_none_was_found(
    kinedex_alone: Kinedex, tmp_path: Path
) -> None:
    (tmp_path / "notes.txt").write_text("buy milk")
    nothing = kinedex_alone("import", str(tmp_path))
    assert (nothing.code, nothing.out.split(":")[0]) == (2, "1 file")
    (tmp_path / "walk.bvh").write_text("buy milk")
    assert kinedex_alone("import", str(tmp_path)).code == 1


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("--meta", "age"), "write KEY=VALUE"),
        (("--meta", "person=x"), "name of a field"),
        (("--labels", "{tsak}/**"), "is `task` meant"),
        (("--labels", "{person}/nowhere/{take}.c3d"), "matches no file"),
    ],
)
def test_a_wrong_option_is_refused_before_anything_is_stored(
    kinedex_alone: Kinedex, mocap: Path, words: tuple[str, ...], part: str
) -> None:
    ended = kinedex_alone("import", str(mocap), *words)
    assert ended.code != 0
    assert part in " ".join(ended.err.split())
    assert ended.out == ""


def test_the_library_itself_is_left_out(kinedex_alone: Kinedex, mocap: Path) -> None:
    inside = {"data_dir": mocap / "library"}
    first = kinedex_alone("import", str(mocap), **inside)
    assert "4 files: 2 new, 0 updated, 0 unchanged, 2 skipped." in first.out
    assert "library/ (a library of Kinedex), notes.txt" in first.out
    again = kinedex_alone("import", str(mocap), **inside)
    assert "4 files: 0 new, 0 updated, 2 unchanged, 2 skipped." in again.out
    refused = kinedex_alone("import", str(mocap / "library"), **inside)
    assert (refused.code, "is the folder of a library" in refused.err) == (1, True)


def test_without_a_terminal_there_is_no_progress_bar(kinedex_alone: Kinedex, mocap: Path) -> None:
    assert kinedex_alone("import", str(mocap)).err == ""


def test_an_error_of_a_manifest_is_printed_once(kinedex_alone: Kinedex, mocap: Path) -> None:
    (mocap / "manifest.csv").write_text("path,tsak\nelin/walk/01.bvh,walk\n")
    refused = kinedex_alone("import", str(mocap))
    assert refused.err.splitlines() == [
        "kinedex: manifest.csv cannot be read: line 1: `tsak` is not the name of a field; is `task`"
        " meant? If it is metadata of your own, write `meta.tsak`."
    ]


def test_warnings_are_summed_up(kinedex_alone: Kinedex, tmp_path: Path) -> None:
    (clip,) = demo_clips(["elin"], ["jump"], takes=1)
    text = clip.content.decode()
    begin = text.index("Frame Time:")
    end = text.index("\n", begin)
    (tmp_path / "fast.bvh").write_text(f"{text[:begin]}Frame Time: 0.015{text[end:]}")
    ended = kinedex_alone("import", str(tmp_path))
    assert "frame_rate_suspect" in ended.out
    assert "fast.bvh: " in ended.out
    listed = _files(kinedex_alone("import", str(tmp_path), "--json"))["fast.bvh"]
    assert [warning["code"] for warning in listed["warnings"]] == ["frame_rate_suspect"]
