"""`kinedex evaluate keyposes`: from a manifest to Table 1."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.services.imports.imports import import_path
from app.services.library.library import Library
from tests.cli.conftest import Kinedex
from tests.formats.csv.files import rows_of
from tests.libraries import settings_for, work
from tests.named_dances import TEMPI, write_dances

COMMAND = ("evaluate", "keyposes")


@pytest.fixture(scope="module")
def danced(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The data directory of a library of annotated dances, without models."""
    folder = tmp_path_factory.mktemp("dances")
    write_dances(folder, seconds=8.0)
    settings = settings_for(tmp_path_factory.mktemp("danced"))
    lib = Library.open(settings)
    import_path(lib, folder)
    work(settings)
    lib.close()
    return settings.data_dir


def test_tables_for_people_fit_a_terminal(kinedex: Kinedex, danced: Path) -> None:
    ended = kinedex(*COMMAND, data_dir=danced)
    assert ended.code == 0, ended.err
    assert "clip    true  found r  right r" in ended.out
    assert "end-effectors  learned" in ended.out
    assert "recall" in ended.out
    assert max(map(len, ended.out.splitlines())) <= 80
    assert "…" not in ended.out


def test_json_and_csv_for_programs(kinedex: Kinedex, danced: Path, tmp_path: Path) -> None:
    file = tmp_path / "tables.csv"
    options = ("--json", "--tolerance", "0.05", "--csv", str(file))
    result = kinedex(*COMMAND, *options, data_dir=danced).json()
    assert result["tolerance"] == 0.05
    assert len(result["clips"]) == result["recordings"] == len(TEMPI)
    rms = result["methods"]["rms"]
    assert set(rms) == {
        "held_out", "usual_thresholds", "learned", "over_t1", "over_t2", "by_group"
    }  # fmt: skip
    assert len(rms["over_t1"]["values"]) == len(rms["over_t1"]["recall"])
    rows = rows_of(file)
    assert {row["table"] for row in rows} == {"clips", "methods", "over_t1", "over_t2"}
    recalls = [float(r["recall"]) for r in rows if r["curve"].startswith("rms, T2 =")]
    assert recalls == pytest.approx(rms["over_t1"]["recall"], abs=1e-6)


def test_a_fit_learns_thresholds_from_the_keyposes_of_the_manifest(
    kinedex: Kinedex, danced: Path
) -> None:
    fitted = kinedex("fit", "--json", data_dir=danced).json()
    model = fitted["result"]["models"]["keyposes"]
    assert model["outcome"] == "fitted"
    assert model["figures"]["clips"] == len(TEMPI)


@pytest.mark.slow
def test_pictures_are_written_to_the_given_paths(
    kinedex: Kinedex, danced: Path, tmp_path: Path
) -> None:
    curves, folder = tmp_path / "curves.png", tmp_path / "clips"
    options = ("--picture", str(curves), "--pictures", str(folder), "--picture-format", "png")
    ended = kinedex(*COMMAND, *options, data_dir=danced)
    assert ended.code == 0, ended.err
    assert curves.read_bytes().startswith(b"\x89PNG")
    assert len(list(folder.glob("clip_*.png"))) == len(TEMPI) + 1


@pytest.mark.slow
def test_pictures_need_no_annotation(kinedex: Kinedex, tmp_path: Path) -> None:
    walks = ("--filter", '{"task": "walk"}')
    ended = kinedex(*COMMAND, *walks, "--pictures", str(tmp_path / "walks"))
    assert ended.code == 0, ended.err
    assert "4 pictures are in" in ended.out
    assert len(list((tmp_path / "walks").glob("*.svg"))) == 4


def test_wrong_options_are_refused(kinedex: Kinedex) -> None:
    ended = kinedex(*COMMAND)
    assert ended.code != 0
    assert "keyposes that a person annotated" in ended.err
    assert kinedex(*COMMAND, "--tolerance", "0").code != 0
    assert kinedex(*COMMAND, "--picture", "x.bmp").code != 0
