"""`kinedex synthesize` writes a BVH file and reports its quality."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.formats.read import read_recording
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from kinedex import KinedexError
from tests.cli.in_process import Run, running
from tests.libraries import ready_clips, ready_library, some_demo_clips  # noqa: F401


@pytest.fixture
def run(
    ready_library: Library,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Run:
    return running("synthesize", ready_library, tmp_path, monkeypatch)


def test_the_file_is_written_and_reported_as_json(
    run: Run,
    ready_clips: list[ClipRecord],  # noqa: F811
    tmp_path: Path,
) -> None:
    walks = next(c for c in ready_clips if (c.person, c.task) == ("ada", "walk"))
    result = run("kick", "--clip", walks.id, "-o", "kick.bvh", "--json")
    document = json.loads(result.stdout)
    content = (tmp_path / "kick.bvh").read_bytes()
    assert (document["path"], document["bytes"]) == ("kick.bvh", len(content))
    assert document["quality"]["kind"] == "new_person"
    assert len(read_recording(content).positions) == document["clip"]["frames"]
    assert "motion" not in document


def test_the_quality_is_printed_as_a_table(run: Run, tmp_path: Path) -> None:
    result = run("bow", "--person", "ada")
    assert result.exit_code == 0, result.output
    assert [file.name for file in tmp_path.iterdir()] == ["ada bow (synthesized).bvh"]
    assert "did record this task" in result.output
    assert "not measured" in result.output


def test_wrong_arguments_are_refused(run: Run) -> None:
    assert run("walk").exit_code == 2
    assert run("walk", "--person", "ada", "--clip", "x").exit_code == 2
    unknown = run("walk", "--person", "nobody").exception
    assert isinstance(unknown, KinedexError)
    assert (unknown.status, unknown.code) == (404, "not_found")
    assert [place.location for place in unknown.errors] == ["body.person"]
