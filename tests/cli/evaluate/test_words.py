"""`kinedex evaluate words`: tables, JSON, a picture."""

from __future__ import annotations

from pathlib import Path

from tests.cli.conftest import Kinedex
from tests.formats.csv.files import rows_of

METHODS = [
    "prior",
    "default",
    "cca",
    "cca-score",
    "cca-10",
    "cca-distance",
    "printed",
    "cca-symbol",
]


def test_tables_for_people(kinedex: Kinedex, tmp_path: Path) -> None:
    picture = tmp_path / "new" / "figure_7.svg"
    ended = kinedex("evaluate", "words", "--query", "wave", "--picture", str(picture))
    assert ended.code == 0, ended.err
    lines = ended.out.splitlines()
    assert lines[0].startswith("12 clips, ")
    assert lines[2].split() == [
        "method",
        *["top-3", "words", "word", "F", "word", "MAP", "set", "F", "set", "MAP"],
    ]
    assert [line.split()[0] for line in lines[3:11]] == METHODS
    assert "set MAP" in ended.out
    assert "0.822" in ended.out
    assert "Log loss of held-out words in the mode cca, by dimensions: 10: " in ended.out
    assert "Canonical correlations (pseudo-inverse): " in ended.out
    assert "Too rare to judge one by one, in fewer than 5 recordings: " in ended.out
    assert "Nearest to wave in the correlated space as printed (table 2):" in ended.out
    assert picture.read_bytes().startswith(b"<?xml")


def test_json_and_csv_for_programs(kinedex: Kinedex, tmp_path: Path) -> None:
    file = tmp_path / "tables.csv"
    result = kinedex("evaluate", "words", "--json", "--csv", str(file)).json()
    rows = rows_of(file)
    words = {row["word"] for row in rows if row["table"] == "words"}
    assert words == {one["word"] for one in result["by_word"] if not one["too_rare"]}
    curve = [float(row["recall"]) for row in rows if row["table"] == "precision_at_recall"]
    assert len(curve) == len(METHODS) * len(result["recalls"])
    assert [row["method"] for row in result["figures"]] == METHODS
    assert [row["method"] for row in result["in_sample"]] == METHODS
    assert all(len(row["precision"]) == len(result["recalls"]) for row in result["figures"])
    assert result["words"] == len(result["by_word"])
    assert {"word_error", "word_brier", "set_error"} <= result["reliability"]["default"].keys()
    ratios = [near["ratio"] for near in result["examples"][0]["nearest"]]
    assert ratios == sorted(ratios)
    assert result["paper"] == {"set_f": 0.598, "set_map": 0.822, "top_3_left_out": 0.72}
    assert result["left_out"].keys() == {"cca", "printed"}


def test_wrong_options_are_refused(kinedex: Kinedex) -> None:
    for words, expected in (
        (("--query", "zebra"), "no clip carries a word of 'zebra'"),
        (("--picture", "figure.gif"), ".svg, .png, .pdf"),
        (("--filter", '{"task": "nothing"}'), "too few"),
    ):
        ended = kinedex("evaluate", "words", *words)
        assert ended.code == 1
        assert expected in ended.err
