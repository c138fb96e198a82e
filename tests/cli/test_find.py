"""The commands that search, recognize and fit: their tables, and the same JSON as the API."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from app.api.schemas.recognition import Recognition
from app.api.schemas.search import MotionHits, WordHits
from tests.cli.conftest import Kinedex
from tests.formats.acclaim.files import acclaim_person
from tests.formats.fbx.takes import person_takes


def _file(folder: Path, task: str) -> str:
    return str(folder / "ada" / f"{task}_01.bvh")


def test_a_file_finds_itself_and_similar_clips(kinedex: Kinedex, folder: Path) -> None:
    asked = ("search", _file(folder, "kick"), "--limit", "3", "--json")
    found = kinedex(*asked, "--include-self").json()
    assert MotionHits.model_validate(found).model_dump(mode="json") == found
    assert found["items"][0]["distance"] == 0.0
    assert [hit["clip"]["task"] for hit in found["items"]] == ["kick"] * 3
    others = [hit["clip"]["id"] for hit in kinedex(*asked).json()["items"]]
    assert others[:2] == [hit["clip"]["id"] for hit in found["items"][1:]]


def test_a_stored_clip_is_searched_with_a_method_and_a_filter(
    kinedex: Kinedex, folder: Path
) -> None:
    asked = ("search", _file(folder, "kick"), "--include-self", "--limit", "1", "--json")
    found = kinedex(*asked).json()
    clip = found["items"][0]["clip"]["id"]
    person = '{"person": "bruno"}'
    hits = kinedex("search", clip, "--method", "dtw", "--filter", person, "--json").json()
    assert hits["method"] == "dtw"
    assert {hit["clip"]["person"] for hit in hits["items"]} == {"bruno"}


def test_a_file_is_searched_with_learned_metrics(kinedex: Kinedex, folder: Path) -> None:
    assert kinedex("fit").code == 0
    for factor, label in (("task", "kick"), ("person", "ada")):
        arguments = ("search", _file(folder, "kick"), "--method", f"metric-{factor}", "--json")
        hits = kinedex(*arguments).json()
        assert hits["method"] == f"metric-{factor}"
        assert hits["items"][0]["clip"][factor] == label
        others = kinedex(*arguments, "--filter", f'{{"not_{factor}": "{label}"}}').json()["items"]
        assert others
        assert label not in {hit["clip"][factor] for hit in others}


def test_hits_are_printed_as_a_table(kinedex: Kinedex, folder: Path) -> None:
    ended = kinedex("search", _file(folder, "walk"), "--include-self", "--limit", "2")
    assert ended.code == 0
    lines = ended.out.splitlines()
    assert lines[0].split() == ["rank", "score", "distance", "name", "person", "task", "id"]
    rank, score, _, title, *labels = lines[1].split()[:6]
    assert (rank, score, labels) == ("1", "1.000", ["ada", "walk"])
    assert title.endswith("walk_01.bvh")
    assert len(lines) == 3


def test_parts_of_clips_are_found_with_their_bounds(kinedex: Kinedex, folder: Path) -> None:
    part = ("search", _file(folder, "kick"), "--start", "0.5", "--end", "2.0")
    arguments = (*part, "--scope", "windows", "--limit", "2", "--include-self")
    found = kinedex(*arguments, "--json").json()
    assert MotionHits.model_validate(found).model_dump(mode="json") == found
    first = found["items"][0]
    assert (first["clip"]["person"], first["clip"]["task"]) == ("ada", "kick")
    assert [first["start"], first["end"]] == pytest.approx([0.5, 2.0], abs=0.11)
    lines = kinedex(*arguments).out.splitlines()
    columns = ["rank", "score", "start", "end", "name", "person", "task", "id"]
    assert lines[0].split() == columns
    assert lines[1].split()[2:4] == [f"{first['start']:.3f}", f"{first['end']:.3f}"]
    assert "scope: " in _refused(kinedex, *part, "--scope", "frames")
    moments = kinedex("search", "--words", "kick", "--scope", "windows", "--json").json()["items"]
    assert moments[0]["clip"]["task"] == "kick"
    assert 0 <= moments[0]["start"] < moments[0]["end"]


def test_words_find_clips_and_unknown_words_are_printed(kinedex: Kinedex) -> None:
    found = kinedex("search", "--words", "kick nosuchword", "--limit", "2", "--json").json()
    assert WordHits.model_validate(found).model_dump(mode="json") == found
    assert found["unknown_words"] == ["nosuchword"]
    assert found["items"][0]["clip"]["task"] == "kick"
    ended = kinedex("search", "--words", "kick", "--words", "nosuchword")
    assert "No clip has the words: nosuchword" in ended.err


def test_recognition_prints_person_and_task(kinedex: Kinedex, folder: Path) -> None:
    found = kinedex("recognize", _file(folder, "kick"), "--json").json()
    assert Recognition.model_validate(found).model_dump(mode="json") == found
    assert (found["person"]["label"], found["task"]["label"]) == ("ada", "kick")
    ended = kinedex("recognize", _file(folder, "kick"))
    rows = [line.split()[:2] for line in ended.out.splitlines()]
    assert ["person", "ada"] in rows
    assert ["task", "kick"] in rows


def test_a_query_in_two_files_and_one_of_several_animations(
    kinedex: Kinedex, tmp_path: Path
) -> None:
    asf, amc, _ = acclaim_person(frames=60, seed=5)
    takes = person_takes({"bow": 1.0, "sway": 2.0})
    for name, content in (("07.asf", asf), ("07_01.amc", amc), ("takes.fbx", takes)):
        (tmp_path / name).write_bytes(content)
    alone = tmp_path / "alone" / "07_01.amc"
    alone.parent.mkdir()
    alone.write_bytes(amc)
    pair = (str(alone), "--skeleton", str(tmp_path / "07.asf"))
    stack = (str(tmp_path / "takes.fbx"), "--stack")
    for command in ("search", "recognize"):
        assert kinedex(command, *pair).code == 0
        assert kinedex(command, *stack, "bow").code == 0
        assert kinedex(command, str(tmp_path / "07_01.amc")).code == 0  # 07.asf is beside it
        assert "`skeleton`" in _refused(kinedex, command, pair[0])
        assert "(bow, sway), found 'run'" in _refused(kinedex, command, *stack, "run")
    one, other = (kinedex("search", *stack, n, "--json").json()["items"] for n in ("bow", "sway"))
    assert [hit["distance"] for hit in one] != [hit["distance"] for hit in other]
    assert kinedex("search", pair[0], "--skeleton", str(tmp_path / "no.asf")).code == 2


def test_a_fit_shows_a_held_out_figure_of_each_model(kinedex: Kinedex) -> None:
    ended = kinedex("fit")
    assert ended.code == 0
    table = ended.out.split("\n\n")[0].splitlines()[1:]
    rows = {line.split()[0]: line.split()[3:] for line in table}
    assert len(rows) == len(table)  # a line for each model
    assert set(rows) == {
        "words",
        "recognizer",
        "multilinear",
        "signatures",
        "perera",
        "synthesis",
        "metric-task",
        "metric-person",
    }
    assert rows["recognizer"][:-1] == ["held_out", "default", "task"]
    assert 0.0 <= float(rows["recognizer"][-1]) <= 1.0


def test_a_fit_gives_all_figures_as_csv(kinedex: Kinedex) -> None:
    lines = list(csv.DictReader(io.StringIO(kinedex("fit", "--csv").out)))
    shares = {one["held out"]: one["figure"] for one in lines if one["model"] == "recognizer"}
    for method in ("prior", "default"):
        assert 0.0 <= float(shares[f"held_out {method} task"]) <= 1.0


def test_a_wrong_query_gets_a_clear_message(kinedex: Kinedex, folder: Path) -> None:
    neither = "kinedex: There is no file 'missing.bvh', and no clip has that id.\n"
    for command in (("recognize",), ("search-pose", "--time", "0")):
        assert _refused(kinedex, *command, "missing.bvh") == neither
    words_too = f"{neither[:-1]} Use --words to search by words.\n"
    assert _refused(kinedex, "search", "missing.bvh") == words_too
    assert f"{folder} cannot be read: Is a directory" in _refused(kinedex, "search", str(folder))
    not_there = "There is no clip with the id 'missing.bvh'\n"
    assert _refused(kinedex, "export", "missing.bvh").endswith(not_there)
    assert _refused(kinedex, "synthesize", "kick", "--clip", "missing.bvh").endswith(not_there)
    assert "filter: " in _refused(kinedex, "search", _file(folder, "walk"), "--filter", "{")
    assert "filter.tusk: " in _refused(kinedex, "search", "x", "--filter", '{"tusk": "walk"}')
    assert "start: " in _refused(kinedex, "search", _file(folder, "walk"), "--start", "99")


def _refused(kinedex: Kinedex, *words: str) -> str:
    ended = kinedex(*words)
    assert (ended.code, ended.out) == (1, "")
    assert "Traceback" not in ended.err
    return ended.err


def test_a_query_of_several_parts_is_answered_and_explained(kinedex: Kinedex) -> None:
    listed = kinedex("clips", "list", "--json").json()["items"]
    kick = next(clip["id"] for clip in listed if clip["task"] == "kick")
    walk = next(clip["id"] for clip in listed if clip["task"] == "walk")
    asked = ("query", "--like", kick, "--unlike", walk, "--body", '{"method": "vector"}')
    found = kinedex(*asked, "--limit", "3", "--json").json()
    assert (found["method"], len(found["items"])) == ("vector", 3)
    best = found["items"][0]["clip"]["id"]
    why = kinedex(*asked, "--why", best, "--json").json()
    assert [part["part"] for part in why["parts"]] == ["examples.0", "examples.1"]
    table = kinedex(*asked, "--why", best).out
    assert "hit 1" in table
    assert " cm" in table
    refused = kinedex("query", "--body", '{"exmples": []}')
    assert refused.code == 1
    assert "exmples" in refused.err
