"""CSV: tables that any program reads, and names that no spreadsheet runs."""

from __future__ import annotations

import csv
import io
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.formats.csv.writer import BLOCK_ROWS, Cell, axis_columns, csv_table, csv_tracks

CELLS = st.none() | st.booleans() | st.integers() | st.floats(width=32) | st.text(max_size=20)


def rows_of(blocks: object) -> list[list[str]]:
    text = b"".join(blocks).decode()  # type: ignore[arg-type]
    return list(csv.reader(io.StringIO(text, newline="")))


def test_tracks_are_times_and_values() -> None:
    frames = BLOCK_ROWS + 5
    positions = np.random.default_rng(0).normal(size=(frames, 2, 3)).astype(np.float32)
    columns = axis_columns(["Hips", 'a, "b"\nc'], "m")
    head, *rows = rows_of(csv_tracks(columns, positions.reshape(frames, -1), 50.0))
    assert head[:4] == ["time_s", "Hips_x_m", "Hips_y_m", "Hips_z_m"]
    assert head[4] == 'a, "b"\nc_x_m'
    numbers = np.array(rows, dtype=float)
    np.testing.assert_allclose(numbers[:, 0], np.arange(frames) / 50)
    np.testing.assert_allclose(numbers[:, 1:], positions.reshape(frames, 6), atol=1e-6)


def test_what_is_not_known_is_empty_and_constants_stand_at_the_end() -> None:
    values = np.array([[1.5, np.nan], [-0.00001, 2.0]])
    head, *rows = rows_of(
        csv_tracks(["a_deg", "b_deg"], values, 2.0, decimals=3, constants=[("from", "x,y")])
    )
    assert head == ["time_s", "a_deg", "b_deg", "from"]
    assert rows == [["0.000000", "1.500", "", "x,y"], ["0.500000", "0.000", "2.000", "x,y"]]


def test_lines_end_as_the_standard_says() -> None:
    content = b"".join(csv_table(["a", "b"], [[1, None], [2.5, "x"]]))
    assert content == b"a,b\r\n1,\r\n2.500000,x\r\n"


@given(rows=st.lists(st.tuples(CELLS, CELLS), max_size=5))
def test_any_table_has_its_rows_and_columns(rows: list[tuple[Cell, Cell]]) -> None:
    head, *found = rows_of(csv_table(["one", "two"], rows))
    assert head == ["one", "two"]
    assert len(found) == len(rows)
    for before, after in zip(rows, found, strict=True):
        for cell, text in zip(before, after, strict=True):
            assert_same(cell, text)


def assert_same(cell: Cell, text: str) -> None:
    if isinstance(cell, str):
        assert text in (cell, f"'{cell}")
    elif isinstance(cell, bool):
        assert text == str(cell).lower()
    elif cell is None or not math.isfinite(cell):
        assert text == ""
    else:
        assert float(text) == pytest.approx(cell, abs=1e-6)


def test_no_text_is_a_formula_but_numbers_keep_their_sign() -> None:
    head, row = rows_of(csv_table(["=1+1", "@x"], [["+y", -3]]))
    assert head == ["'=1+1", "'@x"]
    assert row == ["'+y", "-3"]
