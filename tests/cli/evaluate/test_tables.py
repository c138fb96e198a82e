"""The tables of evaluations in one CSV file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import typer

from app.cli.evaluate.confusion_table import print_confusion
from app.cli.evaluate.tables import check_csv, keep_table, report, show_table
from app.errors import BadField
from kinedex import read_tables
from tests.cli.conftest import Kinedex
from tests.formats.csv.files import rows_of

TASKS = ("--filter", '{"task": ["walk", "wave"]}')


def print_some() -> None:
    typer.echo("For people:")
    show_table("scores", ["name", "score"], [["a", np.float64(1 / 3)], ["b", None]], 1)
    keep_table("counts", ["name", "count"], [["c", np.int64(3)]])


def test_all_tables_stand_in_one_file_and_rows_are_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "new" / "tables.csv"
    report(dict, print_some, as_json=False, csv_file=file)
    assert rows_of(file) == [
        {"table": "scores", "name": "a", "score": "0.333333", "count": ""},
        {"table": "scores", "name": "b", "score": "", "count": ""},
        {"table": "counts", "name": "c", "score": "", "count": "3"},
    ]
    shown = capsys.readouterr().out
    assert "For people" in shown
    assert "\nb" not in shown


def test_the_file_becomes_data_frames(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    report(dict, print_some, as_json=False, csv_file=tmp_path / "tables.csv")
    scores, counts = read_tables(tmp_path / "tables.csv").values()
    assert list(scores.columns) == ["name", "score"]
    assert scores["score"].isna().tolist() == [False, True]
    assert counts.to_dict("records") == [{"name": "c", "count": 3}]


def test_json_and_csv_go_together(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report(lambda: {"a": 1}, print_some, as_json=True, csv_file=tmp_path / "tables.csv")
    assert json.loads(capsys.readouterr().out) == {"a": 1}
    assert len(rows_of(tmp_path / "tables.csv")) == 3


def test_a_confusion_is_a_row_a_pair(tmp_path: Path) -> None:
    shares = np.array([[0.75, 0.25], [0.0, 1.0]])
    report(
        dict,
        lambda: print_confusion(["kick", "walk"], shares),
        as_json=False,
        csv_file=tmp_path / "tables.csv",
    )
    rows = rows_of(tmp_path / "tables.csv")
    assert [(row["true"], row["taken for"], float(row["share"])) for row in rows] == [
        ("kick", "kick", 0.75), ("kick", "walk", 0.25), ("walk", "kick", 0), ("walk", "walk", 1),
    ]  # fmt: skip


def test_a_path_that_cannot_be_written_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(BadField) as refused:
        check_csv(tmp_path)
    assert refused.value.places[0].location == "csv"
    (tmp_path / "file").touch()
    with pytest.raises(BadField):
        check_csv(tmp_path / "file" / "tables.csv")


@pytest.mark.parametrize(
    ("evaluation", "tables"),
    [
        ("retrieval", {"figures", "true_positive_rates"}),
        ("low-dimensional", {"dimensions", "poses", "groups"}),
    ],
)
def test_evaluations_write_their_tables(
    kinedex: Kinedex, tmp_path: Path, evaluation: str, tables: set[str]
) -> None:
    file = tmp_path / "tables.csv"
    ended = kinedex("evaluate", evaluation, *TASKS, "--csv", str(file))
    assert ended.code == 0, ended.err
    assert tables <= {row["table"] for row in rows_of(file)}
