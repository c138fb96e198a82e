"""`kinedex evaluate retrieval`: tables, JSON, pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Kinedex

QUICK = ("evaluate", "retrieval", "--method", "vector", "--method", "msv-xcorr")


def test_tables_for_people(kinedex: Kinedex) -> None:
    ended = kinedex(*QUICK, "--k", "3")
    assert ended.code == 0, ended.err
    lines = ended.out.splitlines()
    assert lines[0] == "12 clips are queries for the others of their task, among 12:"
    assert lines[2].split() == ["method", "1-NN", "P@4", "P@20", "MAP"]
    assert [line.split()[0] for line in lines[3:6]] == ["vector", "msv-xcorr", "msv-xcorr"]
    assert ["method", "kick", "walk", "wave", "overall"] in [line.split() for line in lines]
    assert any(
        line.startswith("True classes, and classes of the 3 nearest clips by") for line in lines
    )
    row = next(line for line in lines if line.startswith(" 1 kick"))
    assert sum(int(cell) for cell in row.split()[2:] if cell != ".") == pytest.approx(100, abs=1)
    assert "Compression ratio (section 5.3): 0.0" in ended.out


def test_json_for_programs(kinedex: Kinedex) -> None:
    result = kinedex(*QUICK, "--classes", "walk,kick", "--eta", "0.4", "--json").json()
    names = [row["method"] for row in result["figures"]]
    assert names[:3] == ["vector", "msv-xcorr", "msv-xcorr q=1"]
    assert names[3:5] == ["msv-xcorr q=1 eta=0.4", "msv-xcorr q=2 eta=0.4"]
    assert names[5:] == ["rho alone", "msv-xcorr normalized"]
    rates = result["true_positive_rates"]
    assert (rates["classes"], rates["k"], rates["mixture"]) == (["walk", "kick"], 20, 12)
    for name in names:
        row = rates["methods"][name]
        assert row["overall"] == pytest.approx((row["walk"] + row["kick"]) / 2)
        matrix = result["confusion"]["methods"][name]
        assert [sum(line) for line in matrix] == pytest.approx([1.0] * 3)
    assert result["volumes"]["converged"] == result["volumes"]["clips"] == 8
    assert result["left_out"] == {"unlabeled": 0, "alone": 0}


def test_pictures_are_written_to_the_given_paths(kinedex: Kinedex, tmp_path: Path) -> None:
    one, folder = tmp_path / "new" / "figure_8.png", tmp_path / "all"
    ended = kinedex(*QUICK[:4], "--picture", str(one), "--pictures", str(folder))
    assert ended.code == 0, ended.err
    assert one.read_bytes().startswith(b"\x89PNG")
    drawn = ("confusion-vector", "matrices", "volumes", "vectors", "convergence")
    names = {f"{name}.svg" for name in drawn}
    assert {path.name for path in folder.iterdir()} == names


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--classes", "walk,fly"), "'fly', only the tasks kick, walk, wave"),
        (("--filter", '{"task": "walk"}'), "'walk', so every answer would be right"),
        (("--filter", '{"task": "nothing"}'), "nothing can be judged"),
        (("--picture", "figure.gif"), ".svg, .png, .pdf"),
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
    ended = kinedex(*QUICK, *words)
    assert ended.code == 1
    assert expected in ended.err
    assert list(tmp_path.iterdir()) == []
