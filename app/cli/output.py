"""The output of commands: JSON and CSV for programs, tables for people."""

from __future__ import annotations

import csv
import json
import os
import sys
import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from app.formats.csv.formulas import guarded

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
AsCsv = Annotated[bool, typer.Option("--csv", help="Print CSV (RFC 4180), with a header.")]

MAX_WIDTH = 100
"""Characters in a line of the output for people."""

MAX_PATH, MAX_NARROW_PATH = 36, 14
"""Characters of a path in a table; MAX_NARROW_PATH: if lines are shorter than MAX_WIDTH."""

SMALLEST = 0.0005
"""Smaller positive numbers have no digit other than 0 among three decimals."""

console = Console()
if not (console.is_terminal or "COLUMNS" in os.environ):
    console.width = MAX_WIDTH  # in a file or a pipe, rich would cut names at 80 characters


def print_json(value: Any) -> None:
    """Print one JSON document to standard output."""
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def print_csv(columns: Sequence[str], documents: Iterable[Mapping[str, Any]]) -> None:
    """Print JSON objects as CSV (RFC 4180) to standard output.

    columns: the members to print; `clip.name` is the member `name` of the member `clip`. null is an
    empty field, lists of texts are joined by spaces, other lists and objects are JSON. No text is a
    formula of a spreadsheet (`formulas`).
    """
    from kinedex.tables import flat

    writer = csv.writer(sys.stdout, lineterminator="\r\n")
    writer.writerow(columns)
    for document in documents:
        row = flat(document)
        writer.writerow([_csv_cell(row.get(name)) for name in columns])


def print_text(text: str) -> None:
    """Print text; longer lines are wrapped at MAX_WIDTH characters."""
    for line in _printable(text).split("\n"):
        typer.echo(textwrap.fill(line, MAX_WIDTH, break_long_words=False, break_on_hyphens=False))


def print_table(
    columns: Sequence[str], rows: Sequence[Sequence[object]], *, cut: Collection[str] = ()
) -> None:
    """Print a table. A column that has only numbers is aligned to the right.

    cut: columns whose texts are cut, with an ellipsis, if the table is too wide. Others are
    wrapped. Ids are always complete, so that they can be copied.
    """
    table = Table(box=None, header_style="bold", pad_edge=False, show_header=any(columns))
    for index, name in enumerate(columns):
        cells = [row[index] for row in rows]
        is_numeric = bool(cells) and all(isinstance(cell, int | float) for cell in cells)
        is_id = name == "id" or name.endswith("_id")
        table.add_column(name, justify="right" if is_numeric else "left", no_wrap=is_id)
        if is_id:
            table.columns[-1].min_width = max((len(str(cell)) for cell in cells), default=0)
    for row in rows:
        table.add_row(*(_cell(cell, name in cut) for name, cell in zip(columns, row, strict=True)))
    console.print(table)


def clip_title(name: str, path: str | None) -> str:
    """What a table calls a clip: the end of its path, which tells files with one name apart.

    A name that somebody chose, and that is not that of the file, is the title itself.
    """
    if path is None or PurePosixPath(path).stem != name:
        return name
    most = MAX_PATH if console.width >= MAX_WIDTH else MAX_NARROW_PATH
    return path if len(path) <= most else f"…{path[1 - most :]}"


def progress_bar() -> Progress:
    """A progress bar on standard error. Without a terminal, it prints nothing."""
    errors = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=errors,
        disable=not errors.is_terminal,
    )


def _cell(cell: object, is_cut: bool) -> Text:
    if is_cut:
        return Text(_printable(cell).replace("\n", " "), no_wrap=True, overflow="ellipsis")
    # a word longer than its column goes on in the next line; rich would cut it
    return Text(_printable(cell), overflow="fold")


def _csv_cell(cell: object) -> object:
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, str):
        return guarded(cell)
    return json.dumps(cell, ensure_ascii=False) if isinstance(cell, list | dict) else cell


def _printable(cell: object) -> str:
    """A cell as text: "-" for None, three decimals for floats, no control characters.

    A float that would look like zero is "<0.001".
    """
    if cell is None:
        return "-"
    if isinstance(cell, float):
        return "<0.001" if 0 < cell < SMALLEST else f"{cell:.3f}"
    # other people choose the names; a control character could change the terminal's state
    return "".join(
        c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in str(cell)
    )
