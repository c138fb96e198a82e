"""`kinedex evaluate recognition`: tables, JSON, pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Kinedex
from tests.formats.csv.files import rows_of

COMMAND = ("evaluate", "recognition")
QUICK = (*COMMAND, "--method", "mean-motion", "--method", "prior")


def test_tables_for_people(kinedex: Kinedex) -> None:
    ended = kinedex(*COMMAND)
    assert ended.code == 0, ended.err
    lines = [line.split() for line in ended.out.splitlines()]
    assert " ".join(lines[0][:8]) == "12 clips: 2 persons, 3 tasks, 0 sources."
    by_take = lines.index(["method", "task", "person", "both", "clips"])
    rows = {line[0]: line[1:] for line in lines[by_take + 1 : by_take + 9] if line}
    assert list(rows)[:2] == ["default", "multilinear"]
    assert rows["chance"] == ["0.333", "0.500", "0.167", "12"]
    assert ["method", "task", "person", "given", "person", "task", "given"] in lines
    columns = ["new", "known", "together", "balanced", "AUC", "EER", "worst"]
    assert ["method", "person", *columns] in lines
    columns = ["trials", "person", "task", "both", "effects", "mean", "motion", "real"]
    assert ["other", "tasks", *columns] in lines
    assert "Not judged, person: 3 persons are needed to leave one out; there are 2." in ended.out
    assert "Not judged, source: Two sources are needed" in ended.out
    assert "What tasks are taken for by default, takes left out, %:" in ended.out
    assert "ms a probe after its features" in ended.out


def test_json_and_csv_for_programs(kinedex: Kinedex, tmp_path: Path) -> None:
    file = tmp_path / "tables.csv"
    result = kinedex(*QUICK, "--json", "--csv", str(file)).json()
    tables = {row["table"] for row in rows_of(file)}
    assert {"take_left_out", "task_left_out", "each_task_left_out", "perera"} <= tables
    assert result["clips"]["persons"] == ["ada", "bruno"]
    assert result["clips"]["tasks"] == ["kick", "walk", "wave"]
    by_take = result["left_out"]["take"]
    assert list(by_take["methods"]) == ["mean-motion", "prior"]
    task = by_take["methods"]["mean-motion"]["recognized"]["task"]
    assert task["share"] == pytest.approx(task["right"] / task["of"])
    assert task["interval_95"][0] <= task["share"] <= task["interval_95"][1]
    by_task = result["left_out"]["task"]["methods"]["mean-motion"]["unknown"]["task"]
    assert list(by_task["categories"]) == ["kick", "walk", "wave"]
    errors = by_task["false_acceptance"] + by_task["false_rejection"]
    assert by_task["balanced_accuracy"] == pytest.approx(1 - errors / 2)
    assert by_task["curve"][0] == {"false_acceptance": 0.0, "false_rejection": 1.0}
    assert [row["given"] for row in result["made"]["new_task"]] == [1]
    assert set(result["perera"]["tables"]) == {"least", "printed"}
    for rows in result["perera"]["tables"].values():
        named = [row["category"] for row in rows if row["table"] == 3]
        assert named == ["task recognition", "person recognition"]
        assert all(0 < row["probed"] <= result["perera"]["segments"] for row in rows[:2])
        assert all(row["accuracy"] == row["correct"] / row["probed"] for row in rows[:2])
    assert set(result["takes_a_cell"]) == {"1"}
    assert set(result["not_judged"]) >= {"person", "source", "3-takes"}


def test_pictures_are_written_to_the_given_paths(kinedex: Kinedex, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "figures"
    ended = kinedex(*QUICK, "--pictures", str(folder), "--picture-format", "png")
    assert ended.code == 0, ended.err
    names = {"confusion-person-mean-motion.png", "confusion-task-mean-motion.png", "unknown.png"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in folder.iterdir())


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--method", "guess"), "must be one of default"),
        (("--false-accept-rate", "1.5"), "above 0 and below 1"),
        (("--filter", '{"task": "nothing"}'), "Two ready clips with a person or a task"),
        (("--pictures", "figures", "--picture-format", "bmp"), ".svg, .png, .pdf"),
    ],
)
def test_wrong_options_are_refused_before_the_evaluation(
    kinedex: Kinedex,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    expected: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    ended = kinedex(*COMMAND, *words)
    assert ended.code == 1
    assert expected in ended.err
    assert list(tmp_path.iterdir()) == []
