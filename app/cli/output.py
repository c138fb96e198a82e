"""The output of commands: JSON for programs, tables for people."""

from __future__ import annotations

import json
import os
import textwrap
from collections.abc import Sequence
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]

MAX_WIDTH = 100
"""Characters in a line of the output for people."""

SMALLEST = 0.0005
"""Smaller positive numbers have no digit other than 0 among three decimals."""

console = Console()
if not (console.is_terminal or "COLUMNS" in os.environ):
    console.width = MAX_WIDTH  # in a file or a pipe, rich would cut names at 80 characters


def print_json(value: Any) -> None:
    """Print one JSON document to standard output."""
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def print_text(text: str) -> None:
    """Print text; longer lines are wrapped at MAX_WIDTH characters."""
    for line in _printable(text).split("\n"):
        typer.echo(textwrap.fill(line, MAX_WIDTH, break_long_words=False, break_on_hyphens=False))


def print_table(columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table. A column that has only numbers is aligned to the right."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for index, name in enumerate(columns):
        is_numeric = bool(rows) and all(isinstance(row[index], int | float) for row in rows)
        table.add_column(name, justify="right" if is_numeric else "left")
    for row in rows:
        table.add_row(*(Text(_printable(cell)) for cell in row))
    console.print(table)


def progress_bar() -> Progress:
    """A progress bar on standard error. Without a terminal, it prints nothing."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    )


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
