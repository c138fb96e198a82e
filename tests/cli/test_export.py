"""`kinedex export` writes a complete file or nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.errors import BadField
from app.formats.read import read_recording
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from tests.cli.in_process import Run, running
from tests.libraries import ready_clips, ready_library, some_demo_clips  # noqa: F401


@pytest.fixture
def run(
    ready_library: Library,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Run:
    return running("export", ready_library, tmp_path, monkeypatch)


@pytest.fixture
def walk(ready_clips: list[ClipRecord]) -> ClipRecord:  # noqa: F811
    return next(clip for clip in ready_clips if clip.task == "walk")


def test_the_default_file_has_the_name_of_the_clip(
    run: Run, walk: ClipRecord, tmp_path: Path
) -> None:
    result = run(walk.id)
    assert result.exit_code == 0, result.output
    (file,) = tmp_path.iterdir()
    assert file.name == f"{walk.name}.bvh"
    assert str(file.stat().st_size) in result.output
    assert len(read_recording(file.read_bytes()).positions) == walk.frames


def test_the_suffix_selects_the_format(run: Run, walk: ClipRecord, tmp_path: Path) -> None:
    result = run(walk.id, "-o", "out.NPZ", "--fps", "10", "--skeleton", "canonical", "--json")
    result = json.loads(result.stdout)
    content = (tmp_path / "out.NPZ").read_bytes()
    assert result == {"path": "out.NPZ", "format": "npz", "bytes": len(content)}
    recording = read_recording(content)
    assert (recording.frame_rate, len(recording.skeleton)) == (10, 18)


@pytest.mark.parametrize("output", ["out.fbx", "out", "nowhere/out.bvh"])
def test_a_path_that_cannot_be_written_leaves_no_file(
    run: Run, walk: ClipRecord, tmp_path: Path, output: str
) -> None:
    result = run(walk.id, "-o", output)
    assert isinstance(result.exception, BadField)
    assert result.exception.places[0].location == "output"
    assert list(tmp_path.iterdir()) == []


def test_an_older_file_stays_if_the_clip_does_not_exist(run: Run, tmp_path: Path) -> None:
    (tmp_path / "kept.csv").write_text("mine")
    result = run("clip_none", "-o", "kept.csv")
    assert result.exit_code != 0
    assert (tmp_path / "kept.csv").read_text() == "mine"
