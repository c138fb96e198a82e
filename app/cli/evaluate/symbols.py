"""`kinedex evaluate symbols`: the motion symbol space of your own library (Takano, fig. 3)."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.running import parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, report, show_table
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_text
from app.cli.settings import open_library
from app.models.held_out.symbols import SymbolFigures
from app.models.words.correlated_words import chosen_dimensions
from app.models.words.symbol_space import DIMENSIONS

Picture = Annotated[
    Path | None, typer.Option(help="Draw error against dimensions: a .svg, .png or .pdf file.")
]


def symbols(
    context: typer.Context,
    filter_json: FilterJson = None,
    picture: Picture = None,
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Measure the errors of the motion symbol space by its dimensions (Takano)."""
    check_csv(csv_file)
    filter, drawing = parsed_filter(filter_json), Drawing.prepared(picture)
    with open_library(context) as lib:
        found = evaluate.judge_symbols(lib, filter)
    report(lambda: asdict(found), lambda: _print(found), as_json=as_json, csv_file=csv_file)
    drawing.draw_one(lambda form: evaluate.draw_symbols(found, form))


def _print(found: SymbolFigures) -> None:
    rows = [asdict(errors) for errors in found.errors]
    show_table("errors", list(rows[0]), [list(row.values()) for row in rows])
    print_text(
        f"{found.symbols} symbols. Distances to landmarks are off by "
        f"{found.placing_error:.1%} for symbols placed later, {found.fitting_error:.1%} among "
        f"landmarks. Rank correlation (Spearman) of the fast divergence with Monte Carlo, over "
        f"{found.pairs} pairs: {found.agreement:.4f}."
    )
    paper = next((one for one in found.errors if one.dimensions == DIMENSIONS), None)
    if paper is not None and paper.gamma is not None:
        print_text(
            f"Takano takes {DIMENSIONS} dimensions, where one more lowers his error by gamma = "
            f"0.001; here gamma({DIMENSIONS}) = {paper.gamma:.3f}. The word mode `printed` has "
            f"{DIMENSIONS}."
        )
    if found.losses:
        losses = ", ".join(f"{count}: {loss:.4f}" for count, loss in found.losses.items())
        print_text(
            f"The word mode `cca` has {chosen_dimensions(found.losses)}, which predict held-out "
            f"words best; log loss by dimensions: {losses}."
        )
