"""Figures of the methods on the library's own labels."""

from __future__ import annotations

from typing import Any

import typer

from app.cli.evaluate_keyposes import keyposes
from app.cli.evaluate_low_dimensional import low_dimensional
from app.cli.evaluate_retrieval import retrieval
from app.cli.evaluate_symbols import symbols
from app.cli.evaluate_words import words
from app.cli.find import filter_of
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.search.filters import parse_filter
from app.services import evaluate

program = typer.Typer(help="Figures on your own library.", no_args_is_help=True)
program.command("retrieval")(retrieval)
program.command("keyposes")(keyposes)
program.command("low-dimensional")(low_dimensional)
program.command("symbols")(symbols)
program.command("words")(words)


@program.command("recognition")
def recognition(
    context: typer.Context, filter_json: FilterJson = None, as_json: AsJson = False
) -> None:
    """Person and task, held out, beside the most frequent class."""
    wanted = parse_filter(filter_of(filter_json))
    with open_library(context) as lib:
        found = evaluate.judge_recognition(lib, wanted)
    _show([{"method": method, **shares} for method, shares in found.items()], as_json)


def _show(rows: list[dict[str, Any]], as_json: bool) -> None:
    if as_json:
        print_json(rows)
        return
    columns = list(dict.fromkeys(name for row in rows for name in row))
    print_table(columns, [[row.get(name) for name in columns] for row in rows])
