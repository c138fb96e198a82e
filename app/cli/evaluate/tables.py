"""The tables of an evaluation: printed for people, and written to one CSV file.

All tables of an evaluation stand in one file. Its first column, `table`, names the table of a row;
the other columns are those of all tables, and a row has empty fields in columns of other tables. So
one table is a filter in a spreadsheet, and `kinedex.read_tables(FILE)["figures"]` in Python.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.evaluate.drawing import check_file
from app.cli.files import write_whole
from app.cli.output import print_json, print_table
from app.evaluate.recognition.shares import Share
from app.formats.csv.writer import Cell, csv_table

CsvFile = Annotated[
    Path | None,
    typer.Option(
        "--csv",
        help="Write all tables, whole and unrounded, to this CSV file; the column `table` names "
        "the table of a row.",
    ),
]

Rows = Sequence[Sequence[object]]


@dataclass(frozen=True, slots=True)
class Table:
    """A table by its name."""

    name: str
    columns: tuple[str, ...]
    rows: Rows


_KEPT: ContextVar[list[Table] | None] = ContextVar("tables that are kept", default=None)


def show_table(name: str, columns: Sequence[str], rows: Rows, most: int | None = None) -> None:
    """Print a table, at most the first `most` rows of it; all rows go to the CSV file.

    A Share is printed with its 95 % confidence interval; the CSV file has its value.
    """
    keep_table(name, columns, [[_value(cell) for cell in row] for row in rows])
    print_table(columns, [[_with_interval(cell) for cell in row] for row in rows[:most]])


def _value(cell: object) -> object:
    return cell.value if isinstance(cell, Share) else cell


def _with_interval(cell: object) -> object:
    if not isinstance(cell, Share):
        return cell
    if cell.value is None:
        return None
    low, high = (f"{bound:.2f}" for bound in cell.interval)
    return f"{cell.value:.3f} ({low}-{high})"


def keep_table(name: str, columns: Sequence[str], rows: Rows) -> None:
    """Put a table into the CSV file, if there is one, without printing it."""
    kept = _KEPT.get()
    if kept is not None:
        kept.append(Table(name, tuple(columns), rows))


def check_csv(file: Path | None) -> None:
    """Check, before the work, that the CSV file can be written. Raises BadField."""
    if file is not None:
        check_file("csv", file)


def report(
    document: Callable[[], Any],
    print_tables: Callable[[], None],
    *,
    as_json: bool,
    csv_file: Path | None,
) -> None:
    """Print an evaluation as JSON or as tables, and write the tables to a CSV file.

    print_tables: prints by `show_table`. csv_file: None for no such file.
    """
    with _kept_tables() as tables:
        if not as_json:
            print_tables()
        elif csv_file is not None:
            with contextlib.redirect_stdout(io.StringIO()):
                print_tables()
    if as_json:
        print_json(document())
    if csv_file is not None:
        csv_file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(csv_file, csv_of(tables))


def csv_of(tables: Sequence[Table]) -> Iterator[bytes]:
    """All tables as one CSV file, piece by piece."""
    columns = list(dict.fromkeys(column for table in tables for column in table.columns))
    rows = (
        [table.name, *_spread(dict(zip(table.columns, row, strict=True)), columns)]
        for table in tables
        for row in table.rows
    )
    return csv_table(["table", *columns], rows)


def _spread(cells: dict[str, object], columns: Sequence[str]) -> list[Cell]:
    return [_cell(cells.get(column)) for column in columns]


def _cell(value: object) -> Cell:
    """A value of a table as a value of a CSV file; NumPy's numbers become Python's."""
    if hasattr(value, "item"):
        value = value.item()
    if value is None or isinstance(value, str | int | float):
        return value
    return str(value)


@contextlib.contextmanager
def _kept_tables() -> Iterator[list[Table]]:
    kept: list[Table] = []
    token = _KEPT.set(kept)
    try:
        yield kept
    finally:
        _KEPT.reset(token)
