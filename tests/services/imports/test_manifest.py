"""Manifests: they are read correctly, or refused with the line."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import TooLarge, Unreadable
from app.kinedex_error import KinedexError
from app.services.imports.manifest import Manifest
from app.services.imports.manifest_table import MAX_COLUMNS, MAX_ROW, ManifestLimits
from app.store.clips.record import AnalysisHints, ClipLabels

FEW_ROWS = ManifestLimits(rows=5)

TABLE = (
    "\ufeffpath, Person,task,words,license,source,fps,unit,Up_Axis,remark\r\n"
    'a.bvh,ada,walk,"Walk slow left_leg",CC0,me,60,cm,-Z,"x, y"\r\n'
    "\r\n"
    "deep\\b.bvh,,,,,,,,,\r\n"
)


def _read(content: bytes, folder: str = "", limits: ManifestLimits = FEW_ROWS) -> Manifest:
    manifest = Manifest(limits)
    manifest.read(io.BytesIO(content), folder)
    return manifest


def test_a_row_has_the_values_of_all_columns() -> None:
    manifest = _read(TABLE.encode(), "set")
    row = manifest.row("set/a.bvh")
    words = ("walk", "slow", "left_leg")
    metadata = {"remark": "x, y"}
    assert row.values.labels == ClipLabels("a", "ada", "walk", words, "CC0", "me", metadata)
    assert row.values.hints == AnalysisHints(frame_rate=60.0, metres_per_unit=0.01, up_axis="-z")
    assert row.problem is None
    empty = manifest.row("set/deep/b.bvh")
    assert (empty.values.labels, empty.values.hints) == (ClipLabels("b"), AnalysisHints())


def test_captions_are_separated_by_bars_or_lines() -> None:
    table = 'path,captions\na.bvh,"a walk | he turns\na walk"\nb.bvh,\n'
    manifest = _read(table.encode())
    assert manifest.row("a.bvh").values.labels.captions == ("a walk", "he turns")
    assert manifest.row("b.bvh").values.labels.captions == ()


@pytest.mark.parametrize("separator", [";", "\t"])
def test_separators_of_all_spreadsheet_programs_are_read(separator: str) -> None:
    table = "path,person,words\na.bvh,ada,walk slow\n".replace(",", separator)
    row = _read(table.encode()).row("a.bvh")
    assert (row.values.labels.person, row.values.labels.words) == ("ada", ("walk", "slow"))


@pytest.mark.parametrize(
    ("line", "part"),
    [("a.bvh,fast", "frame_rate"), ("a.bvh,-3", "frame_rate"), ("a.bvh,nan", "frame_rate")],
)
def test_a_row_that_cannot_be_used_keeps_its_problem(line: str, part: str) -> None:
    row = _read(f"path,fps\n{line}\n".encode()).row("a.bvh")
    assert row.problem is not None
    assert row.problem.places[0].location == f"manifest.csv line 2: {part}"


def test_a_path_named_twice_is_a_problem() -> None:
    row = _read(b"path,person\na.bvh,ada\n./a.bvh,bruno\n").row("a.bvh")
    assert row.problem is not None
    assert "line 3" in row.problem.places[0].location


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"", 1),
        (b"file,person\na.bvh,ada\n", 1),
        (b"path,person\na.bvh,ada\nb.bvh,\xff\n", 3),
        (b'path,person\n"a.bvh,ada\n', 2),
    ],
)
def test_content_that_is_no_manifest_is_refused_with_the_line(content: bytes, line: int) -> None:
    with pytest.raises(Unreadable) as refused:
        _read(content)
    assert refused.value.places[0].location == f"manifest.csv line {line}"


@given(st.binary(max_size=300))
def test_any_bytes_give_rows_or_an_error(content: bytes) -> None:
    try:
        _read(b"path,words,fps\n" + content)
    except KinedexError:
        return


class _Endless:
    """A manifest that never ends; `given` is the number of bytes that were read."""

    def __init__(self, head: bytes, again: bytes) -> None:
        self.given = 0
        self._head, self._again = head, again

    def read(self, size: int, /) -> bytes:
        part = (self._head + self._again * (size // len(self._again) + 1))[:size]
        self._head = self._head[size:]
        self.given += len(part)
        return part


@pytest.mark.parametrize(
    ("head", "again", "message"),
    [
        (b"path\n", b"a.bvh\n", "more than 5 rows"),
        (b"path\n", b"\n", "more than 5 rows"),
        (b"path\n", b"a", f"more than {MAX_ROW} characters"),
        (b"path\n" + b"a" * 200_000 + b"\n", b"a\n", "field larger than field limit"),
        (b"path\n", b"a,", f"more than {MAX_ROW} characters"),
        (b"path\n", b'"\n",', f"more than {MAX_ROW} characters"),
        (b"", b"path,", f"more than {MAX_ROW} characters"),
    ],
)
def test_an_endless_manifest_is_refused_with_the_line_after_few_bytes(
    head: bytes, again: bytes, message: str
) -> None:
    content = _Endless(head, again)
    manifest = Manifest(FEW_ROWS)
    with pytest.raises((TooLarge, Unreadable), match=message) as refused:
        manifest.read(content)
    assert refused.value.places[0].location.startswith("manifest.csv line ")
    assert content.given < 2 * MAX_ROW


def test_columns_bytes_and_paths_have_limits() -> None:
    wide = b"path" + b",x" * MAX_COLUMNS
    with pytest.raises(TooLarge, match=f"more than {MAX_COLUMNS} columns"):
        _read(wide)
    with pytest.raises(TooLarge, match="more than 10 bytes"):
        _read(b"path\na.bvh\n", limits=ManifestLimits(5, bytes=10))
    with pytest.raises(TooLarge, match="a path of more than 500 characters"):
        _read(b"path\n" + b"a" * 501)


def test_limits_hold_for_all_manifests_of_an_import_together() -> None:
    manifest = _read(b"path\na.bvh\nb.bvh\nc.bvh\n", "one")
    with pytest.raises(TooLarge, match="more than 5 rows") as refused:
        manifest.read(io.BytesIO(b"path\na.bvh\nb.bvh\nc.bvh\n"), "two")
    assert refused.value.places[0].location == "manifest.csv line 4"


def test_the_later_of_two_manifests_counts() -> None:
    manifest = _read(b"path,person\nset/a.bvh,ada\n")
    manifest.read(io.BytesIO(b"person,path\nbruno,a.bvh\n"), "set")
    assert manifest.row("set/a.bvh").values.labels.person == "bruno"


def test_recordings_have_their_line_and_their_path_from_the_root() -> None:
    manifest = _read(b"path,audio\na.bvh,../song.mp3\n", "set/in")
    assert manifest.recordings() == {"set/song.mp3": 2}
    assert manifest.row("set/in/a.bvh").audio == "set/song.mp3"
