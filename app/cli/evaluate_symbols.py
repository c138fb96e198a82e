"""`kinedex evaluate symbols`: the motion symbol space of one's own library (Takano, fig. 3)."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from app.cli.find import filter_of
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.search.filters import parse_filter
from app.services import evaluate, pictures

Picture = Annotated[
    Path | None, typer.Option(help="Draw error against dimensions: a .svg, .png or .pdf file.")
]


def symbols(
    context: typer.Context,
    filter_json: FilterJson = None,
    picture: Picture = None,
    as_json: AsJson = False,
) -> None:
    """How many dimensions motion symbols need, and how well new ones are placed (Takano)."""
    wanted = parse_filter(filter_of(filter_json))
    form = None if picture is None else pictures.format_of(picture)
    if form is not None:
        pictures.need_plots()
    with open_library(context) as lib:
        found = evaluate.judge_symbols(lib, wanted)
    if picture is not None and form is not None:
        picture.write_bytes(evaluate.draw_symbols(found, form))
    if as_json:
        print_json(asdict(found))
        return
    rows = [asdict(errors) for errors in found.errors]
    print_table(list(rows[0]), [list(row.values()) for row in rows])
    typer.echo(
        f"{found.symbols} symbols. Distances to landmarks are off by "
        f"{found.placing_error:.1%} for symbols placed later, {found.fitting_error:.1%} among "
        f"landmarks. The fast divergence ranks {found.pairs} pairs as Monte Carlo does: "
        f"Spearman {found.agreement:.4f}."
    )
