"""The paths of pictures are checked before an evaluation begins."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from app.cli.evaluate.drawing import Drawing
from app.errors import BadField
from app.services.library.library import Library
from tests.cli.conftest import Kinedex

WITH_FOLDER = ("recognition", "retrieval", "keyposes", "low-dimensional")
WITH_FILE = ("retrieval", "keyposes", "symbols", "words")
COMMANDS = [
    *((name, "--pictures", "") for name in WITH_FOLDER),
    *((name, "--picture", "/figure.svg") for name in WITH_FILE),
]


@pytest.mark.parametrize(("name", "option", "ending"), COMMANDS)
def test_a_wrong_path_is_refused_before_the_library_is_opened(
    kinedex: Kinedex,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    option: str,
    ending: str,
) -> None:
    def open_nothing(*_: object, **__: object) -> Library:
        raise AssertionError("the library was opened")

    monkeypatch.setattr(Library, "open", open_nothing)
    in_the_way = tmp_path / "notes"
    in_the_way.write_text("mine")
    ended = kinedex("evaluate", name, option, f"{in_the_way}{ending}")
    assert (ended.code, ended.out) == (1, "")
    what = option.removeprefix("--")
    why = f"nothing can be written to {in_the_way}: there is a file of that name"
    assert ended.err == f"kinedex: {what}: {why}\n"
    assert in_the_way.read_text() == "mine"


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("notes/deeper", "a part of that path is a file"),
        pytest.param(
            "/proc/figures",
            "no folder can be made there",
            marks=pytest.mark.skipif(sys.platform != "linux", reason="needs /proc"),
        ),
        ("x" * 300, "File name too long"),
    ],
)
def test_paths_that_cannot_be_written_are_refused(tmp_path: Path, path: str, reason: str) -> None:
    (tmp_path / "notes").write_text("mine")
    with pytest.raises(BadField, match=reason):
        Drawing.prepared(folder=tmp_path / path)
    with pytest.raises(BadField, match=reason):
        Drawing.prepared(tmp_path / path / "figure.svg")
    with pytest.raises(BadField, match="File name too long"):
        Drawing.prepared(tmp_path / f"{'x' * 300}.svg")
    assert [file.name for file in tmp_path.iterdir()] == ["notes"]


def test_a_folder_is_not_a_picture_file(tmp_path: Path) -> None:
    (tmp_path / "figure.svg").mkdir()
    with pytest.raises(BadField, match="is a folder, not a file"):
        Drawing.prepared(tmp_path / "figure.svg")


def test_checking_creates_nothing_and_drawing_creates_missing_folders(tmp_path: Path) -> None:
    drawing = Drawing.prepared(tmp_path / "a" / "b" / "one.png", tmp_path / "c" / "d", "pdf")
    assert list(tmp_path.iterdir()) == []
    drawing.draw_one(lambda form: form.encode())
    drawing.draw_all(lambda form: [(f"{name}.{form}", name.encode()) for name in "xy"])
    assert (tmp_path / "a" / "b" / "one.png").read_bytes() == b"png"
    drawn = {path.name: path.read_text() for path in (tmp_path / "c" / "d").iterdir()}
    assert drawn == {"x.pdf": "x", "y.pdf": "y"}


def test_without_paths_nothing_is_drawn(tmp_path: Path) -> None:
    drawing = Drawing.prepared()
    drawing.draw_one(lambda form: pytest.fail(form))
    drawing.draw_all(lambda form: pytest.fail(form))
