"""`kinedex evaluate captions`: sentences about clips, as text-to-motion retrieval judges them."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.cli.evaluate.running import parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, report, show_table
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_text
from app.cli.settings import open_library
from app.evaluate import CaptionEvaluation
from app.models.held_out.captions import BATCH, RECALLS_AT, THRESHOLD

File = Annotated[
    Path,
    typer.Argument(help="A CSV file with the columns path (or id, or name) and caption."),
]


def captions(
    context: typer.Context,
    file: File,
    mode: Annotated[
        str, typer.Option(help="Mode of the search by words: default, cca or printed.")
    ] = "default",
    filter_json: FilterJson = None,
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Rank clips by captions that the library does not have, beside chance."""
    check_csv(csv_file)
    filter = parsed_filter(filter_json)
    with open_library(context) as lib:
        found = evaluate.judge_captions(lib, file, mode, filter)
    report(
        lambda: asdict(found) | {"recalls_at": list(RECALLS_AT)},
        lambda: _print(found),
        as_json=as_json,
        csv_file=csv_file,
    )


def _print(found: CaptionEvaluation) -> None:
    recalls = [f"R@{rank}" for rank in RECALLS_AT]
    rows = []
    for one in found.figures:
        rows.append([one.protocol, one.captions, one.clips, *one.recalls, one.median_rank])
        rows.append(["  chance", "", "", *one.chance_recalls, one.chance_median_rank])
    show_table("captions", ["protocol", "captions", "clips", *recalls, "median rank"], rows)
    print_text(
        f"Mode {found.mode}. threshold: clips count as right whose captions are at least "
        f"{THRESHOLD:g} alike. distinct: captions less alike, among their own clips. batches: the "
        f"right clip among {BATCH}. {found.silent} captions have no word that the library knows."
    )
    if found.stored:
        print_text(f"{found.stored} captions are left out: the library stores them.")
    if found.unknown:
        shown = ", ".join(found.unknown[:10])
        print_text(f"{len(found.unknown)} clips of the file are not in the library: {shown}.")
