"""Manifests: read rightly, or refused with the line."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import KinedexError, Unreadable
from app.services.manifest import read_manifest

TABLE = (
    "\ufeffpath, Person,task,words,license,source,fps,unit,remark\r\n"
    'a.bvh,ada,walk,"Walk slow left_leg",CC0,me,60,cm,"x, y"\r\n'
    "\r\n"
    "deep\\b.bvh,,,,,,,,\r\n"
)


def test_a_row_tells_all_that_its_columns_hold() -> None:
    rows = read_manifest(TABLE.encode(), "set")
    row = rows["set/a.bvh"]
    assert (row.person, row.task, row.license, row.source) == ("ada", "walk", "CC0", "me")
    assert row.words == ("walk", "slow", "left_leg")
    assert (row.frame_rate, row.metres_per_unit, row.problem) == (60.0, 0.01, None)
    empty = rows["set/deep/b.bvh"]
    assert (empty.person, empty.words, empty.frame_rate) == (None, None, None)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_what_spreadsheets_of_other_countries_write_is_read(separator: str) -> None:
    table = "path,person,words\na.bvh,ada,walk slow\n".replace(",", separator)
    (row,) = read_manifest(table.encode()).values()
    assert (row.person, row.words) == ("ada", ("walk", "slow"))


@pytest.mark.parametrize(
    ("line", "part"),
    [("a.bvh,fast", "frame_rate"), ("a.bvh,-3", "frame_rate"), ("a.bvh,nan", "frame_rate")],
)
def test_a_row_that_cannot_be_used_keeps_its_problem(line: str, part: str) -> None:
    (row,) = read_manifest(f"path,fps\n{line}\n".encode()).values()
    assert row.problem is not None
    assert row.problem.places[0].location == f"manifest.csv line 2: {part}"


def test_a_path_named_twice_is_a_problem_of_its_own() -> None:
    row = read_manifest(b"path,person\na.bvh,ada\n./a.bvh,bruno\n")["a.bvh"]
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
def test_what_is_no_manifest_is_refused_with_the_line(content: bytes, line: int) -> None:
    with pytest.raises(Unreadable) as refused:
        read_manifest(content)
    assert refused.value.places[0].location == f"manifest.csv line {line}"


@given(st.binary(max_size=300))
def test_no_bytes_make_anything_but_rows_or_a_refusal(content: bytes) -> None:
    try:
        read_manifest(b"path,words,fps\n" + content)
    except KinedexError:
        return
