"""`kinedex clips`, `jobs` and `status`: tables, JSON and CSV, locally and against a service."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from app.api.schemas.clips import Clip
from app.api.schemas.jobs import Job
from app.demo import demo_clips
from tests.cli.conftest import Ended, Kinedex
from tests.formats.c3d.files import c3d, marker_person, stacked
from tests.live import Live

FAILURE, USAGE = 1, 2


def rows(ended: Ended) -> list[dict[str, str]]:
    """The rows of CSV, which must have the line ends of RFC 4180."""
    assert ended.code == 0, ended.err
    assert "\n" not in ended.out.replace("\r\n", "")
    return list(csv.DictReader(io.StringIO(ended.out)))


def _ids(kinedex: Kinedex, *filters: str) -> list[str]:
    return [row["id"] for row in rows(kinedex("clips", "list", *filters, "--csv"))]


def test_clips_are_listed_in_three_forms(kinedex: Kinedex) -> None:
    filters = ("--task", "kick", "--person", "ada", "--sort", "name")
    found = kinedex("clips", "list", *filters, "--json").json()["items"]
    assert [Clip.model_validate(one).model_dump(mode="json") for one in found] == found
    listed = rows(kinedex("clips", "list", *filters, "--csv"))
    assert [row["id"] for row in listed] == [clip["id"] for clip in found]
    assert listed[0]["words"].split() == found[0]["words"]
    lines = kinedex("clips", "list", *filters).out.splitlines()
    assert lines[0].split() == ["id", "name", "person", "task", "state", "duration"]
    assert found[0]["path"] == "ada/kick_01.bvh"
    assert lines[1].split()[1].endswith("kick_01.bvh")
    assert [line.split()[0] for line in lines[1:]] == [clip["id"] for clip in found]


def test_a_list_is_filtered_and_limited(kinedex: Kinedex) -> None:
    assert len(_ids(kinedex, "--limit", "3")) == 3
    assert len(_ids(kinedex, "--limit", "0")) > 10
    words = '{"not_task": ["kick", "wave"]}'
    assert {r["task"] for r in rows(kinedex("clips", "list", "--filter", words, "--csv"))} <= {
        "walk",
        "",
    }
    assert rows(kinedex("clips", "list", "--task", "nosuch", "--csv")) == []
    wrong = kinedex("clips", "list", "--filter", '{"tusk": "walk"}')
    assert (wrong.code, wrong.out) == (FAILURE, "")
    assert "tusk: " in wrong.err
    assert kinedex("clips", "list", "--limit", "-1").code == USAGE


def test_labels_are_corrected_and_removed(kinedex: Kinedex) -> None:
    (clip,) = _ids(kinedex, "--task", "wave", "--person", "bruno", "--limit", "1")
    before = kinedex("clips", "show", clip, "--json").json()
    changed = kinedex("clips", "label", clip, "--task", "", "--words", "wave high", "--json").json()
    assert (changed["task"], changed["words"]) == (None, ["wave", "high"])
    assert changed["person"] == before["person"]
    back = ("--task", before["task"], "--words", " ".join(before["words"]))
    assert kinedex("clips", "label", clip, *back).code == 0
    assert kinedex("clips", "show", clip, "--json").json() == before
    assert kinedex("clips", "label", clip).code == USAGE
    missing = kinedex("clips", "show", "nosuch")
    assert (missing.code, missing.out) == (FAILURE, "")
    assert missing.err.count("nosuch") == 1


def test_metadata_are_set_shown_filtered_and_removed(kinedex: Kinedex) -> None:
    (clip,) = _ids(kinedex, "--task", "wave", "--person", "bruno", "--limit", "1")
    set_two = ("--meta", "condition=tired", "--meta", "age=30")
    changed = kinedex("clips", "label", clip, *set_two, "--json").json()
    assert changed["metadata"] == {"condition": "tired", "age": 30}
    try:
        shown = dict(
            line.split(maxsplit=2)[1:]
            for line in kinedex("clips", "show", clip).out.splitlines()
            if line.startswith("meta ")
        )
        assert {key: value.strip() for key, value in shown.items()} == {
            "age": "30",
            "condition": "tired",
        }
        for words in (("condition=rested", "condition=tired"), ("age.min=30", "age.max=30")):
            conditions = [word for one in words for word in ("--meta", one)]
            (row,) = rows(kinedex("clips", "list", *conditions, "--csv"))
            assert (row["id"], row["metadata.condition"], row["metadata.age"]) == (
                clip,
                "tired",
                "30",
            )
        assert _ids(kinedex, "--meta", "age.min=31") == []
        assert kinedex("clips", "list", "--meta", "age").code == USAGE
    finally:
        kinedex("clips", "label", clip, "--meta", "condition=", "--meta", "age=")
    assert kinedex("clips", "show", clip, "--json").json()["metadata"] == {}


def test_clips_of_a_folder_are_listed(kinedex: Kinedex) -> None:
    clips = rows(kinedex("clips", "list", "--limit", "0", "--csv"))
    of_ada = [clip["id"] for clip in clips if clip["path"].startswith("ada/")]
    assert _ids(kinedex, "--folder", "ada", "--limit", "0") == of_ada != []


def test_doubts_and_the_start_of_a_clip_are_shown(kinedex_alone: Kinedex, tmp_path: Path) -> None:
    tracks, _ = marker_person(frames=90)
    positions, labels = stacked(tracks)
    empty = np.full((30, *positions.shape[1:]), np.nan)
    positions[40:50, labels.index("LKNE")] += 2000
    file = tmp_path / "late.c3d"
    file.write_bytes(c3d(np.concatenate([empty, positions]), labels))
    imported = kinedex_alone("import", str(file))
    assert imported.code == 0, imported.err
    said = " ".join(imported.out.split())
    assert "bone_length_jumps" in said
    assert "LeftKnee" in said
    assert "frames 40 to 49" in said
    (clip,) = _ids(kinedex_alone)
    found = kinedex_alone("clips", "show", clip, "--json").json()
    assert found["start_offset"] == 0.3
    jumps = [each for each in found["warnings"] if each["code"] == "bone_length_jumps"]
    assert {(each["start"], each["end"]) for each in jumps} == {(0.4, 0.49)}
    assert "LeftKnee" in {each["joint"] for each in jumps}
    shown = " ".join(kinedex_alone("clips", "show", clip).out.split())
    assert "begins 0.300 s after the start of the file" in shown
    assert "warning bone_length_jumps" in shown


def test_a_clip_is_deleted_only_if_the_user_agrees(kinedex: Kinedex, tmp_path: Path) -> None:
    (new,) = demo_clips(["elin"], ["bow"], takes=1)
    file = tmp_path / "deleted.bvh"
    file.write_bytes(new.content)
    assert kinedex("import", str(file), "--no-wait").code == 0
    (clip,) = _ids(kinedex, "--name", "deleted")
    assert kinedex("clips", "delete", clip, "--yes").code == 0
    assert _ids(kinedex, "--name", "deleted") == []


def test_jobs_are_listed_and_shown(kinedex: Kinedex) -> None:
    jobs = kinedex("jobs", "list", "--kind", "import", "--limit", "0", "--json").json()["items"]
    assert [Job.model_validate(job).model_dump(mode="json") for job in jobs] == jobs
    first = jobs[-1]["id"]
    files = rows(kinedex("jobs", "show", first, "--outcome", "failed", "--csv"))
    assert [file["error.code"] for file in files] == ["unreadable"]
    shown = kinedex("jobs", "show", first).out
    assert "broken/half.bvh" in shown
    refused = kinedex("jobs", "cancel", first)
    assert refused.code == USAGE
    assert "has ended" in refused.err
    assert kinedex("jobs", "list", "--state", "nosuch").code == FAILURE


def test_the_status_counts_clips_and_shows_the_models(kinedex: Kinedex) -> None:
    found = kinedex("status", "--json").json()
    assert found["clips"]["ready"] >= 12
    assert found["disk"]["free"] > 0
    values = {row["name"]: row["value"] for row in rows(kinedex("status", "--csv"))}
    assert int(values["clips.ready"]) == found["clips"]["ready"]
    shown = kinedex("status").out
    assert "recognizer" in shown
    assert "GiB free" in shown


@pytest.mark.parametrize(
    "words",
    [
        ("clips", "list", "--limit", "3"),
        ("jobs", "list", "--limit", "3"),
        ("status",),
        ("search", "--words", "kick", "--limit", "3"),
        ("doctor",),
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("form", ["", "--json", "--csv"])
def test_a_command_runs_against_a_service(
    words: tuple[str, ...], form: str, kinedex: Kinedex, demo_service: Live, tmp_path: Path
) -> None:
    ended = kinedex(
        *words, *filter(None, [form]), url=demo_service.url, data_dir=tmp_path / "not-used"
    )
    assert ended.code == 0, ended.err
    if form == "--json":
        assert json.loads(ended.out)
    elif form == "--csv":
        assert rows(ended)
    else:
        assert ended.out
    assert not (tmp_path / "not-used").exists()


def test_both_places_give_the_same_answer(
    kinedex: Kinedex, demo_service: Live, folder: Path
) -> None:
    query = str(folder / "ada" / "kick_01.bvh")
    words = ("search", query, "--method", "vector", "--limit", "2", "--csv")
    columns = ("rank", "score", "distance", "clip.name", "clip.person")
    here, there = (
        [[row[name] for name in columns] for row in rows(kinedex(*words, **place))]
        for place in ({}, {"url": demo_service.url})
    )
    assert here == there
    for command in (("export", "nosuch"), ("clips", "show", "nosuch"), ("search", "nosuch")):
        local, remote = kinedex(*command), kinedex(*command, url=demo_service.url)
        assert (remote.code, remote.err) == (local.code, local.err) == (FAILURE, local.err)
