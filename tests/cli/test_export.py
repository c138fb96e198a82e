"""`kinedex export` writes a complete file or nothing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.errors import BadField, NoGait
from app.formats.read import read_recording
from app.services.clips import catalogue as clips
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


def test_a_table_is_a_csv_file(run: Run, walk: ClipRecord, tmp_path: Path) -> None:
    result = run(walk.id, "--content", "gait")
    assert result.exit_code == 0, result.output
    (file,) = tmp_path.iterdir()
    assert file.name == f"{walk.name}-gait.csv"
    assert file.read_text().startswith("parameter,left_mean,")
    assert run(walk.id, "--format", "csv", "--content", "gait", "--unit", "m").exit_code == 0


def test_several_clips_go_into_a_folder_and_some_are_left_out(
    run: Run,
    ready_clips: list[ClipRecord],  # noqa: F811
    tmp_path: Path,
) -> None:
    result = run("--filter", "{}", "--content", "strides", "-o", "out/gait", "--json")
    assert result.exit_code == 0, result.output
    printed = json.loads(result.stdout)
    walks = {clip.id for clip in ready_clips if clip.task == "walk"}
    assert walks <= {file["clip_id"] for file in printed["files"]}
    assert len(printed["files"]) + len(printed["left_out"]) == len(ready_clips)
    assert all("no walking" in one["reason"] for one in printed["left_out"])
    names = {path.name for path in (tmp_path / "out" / "gait").iterdir()}
    assert names == {Path(file["path"]).name for file in printed["files"]}


def test_clips_of_one_name_get_files_of_their_own(
    run: Run,
    ready_library: Library,  # noqa: F811
    ready_clips: list[ClipRecord],  # noqa: F811
    tmp_path: Path,
) -> None:
    one, other = ready_clips[:2]
    clips.update_clip(ready_library, other.id, {"name": one.name})
    try:
        result = run(one.id, other.id, "-o", "out", "--format", "trc", "--fps", "5")
    finally:
        clips.update_clip(ready_library, other.id, {"name": other.name})
    assert result.exit_code == 0, result.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {f"{one.name}.trc", f"{one.name}-{other.id}.trc"}


def test_an_output_that_is_a_folder_gets_the_file(
    run: Run, walk: ClipRecord, tmp_path: Path
) -> None:
    assert run(walk.id, "-o", str(tmp_path), "--format", "c3d").exit_code == 0
    assert (tmp_path / f"{walk.name}.c3d").is_file()


@pytest.mark.parametrize(
    ("arguments", "location"),
    [
        ((), "clip_ids"),
        (("a", "--filter", "{}"), "filter"),
        (("a", "--content", "gait", "--format", "bvh"), "content"),
        (("--filter", "{", "-o", "out"), "filter"),
    ],
)
def test_what_does_not_go_together_is_named(
    run: Run, arguments: tuple[str, ...], location: str
) -> None:
    result = run(*arguments)
    assert isinstance(result.exception, BadField)
    assert result.exception.places[0].location == location


def test_a_clip_without_walking_says_so(
    run: Run,
    ready_clips: list[ClipRecord],  # noqa: F811
    tmp_path: Path,
) -> None:
    wave = next(clip for clip in ready_clips if clip.task == "wave")
    assert isinstance(run(wave.id, "--content", "gait").exception, NoGait)
    assert run("--filter", '{"task": ["wave"]}', "--content", "gait").exit_code == 1
    assert list(tmp_path.iterdir()) == []


def test_definitions_are_printed_without_a_library(run: Run) -> None:
    result = run("--definitions")
    assert result.exit_code == 0
    assert "knee_flexion_deg" in result.output
    assert "step_width_m" in result.output
