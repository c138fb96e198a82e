"""`kinedex evaluate recognition`: held-out persons and tasks of your own library."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.recognition_tables import print_tables
from app.cli.evaluate.running import judging, parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, report
from app.cli.options import By, FilterJson, PictureFormat
from app.cli.output import AsJson
from app.evaluate.recognition import pictures as recognition_pictures
from app.evaluate.recognition.document import recognition_document

Methods = Annotated[
    list[str] | None,
    typer.Option(
        "--method",
        help=f"Judge this method; may be repeated. One of {', '.join(evaluate.RECOGNIZERS)}.",
    ),
]
Rate = Annotated[
    float | None,
    typer.Option(
        "--false-accept-rate",
        help="For default and perera, 0..1: how often new persons and tasks may be called known.",
    ),
]
Pictures = Annotated[
    Path | None,
    typer.Option(
        "--pictures", help="Draw confusion matrices and curves of unknown labels into this folder."
    ),
]


def recognition(
    context: typer.Context,
    method: Methods = None,
    false_accept_rate: Rate = None,
    filter_json: FilterJson = None,
    by: By = None,
    pictures_dir: Pictures = None,
    picture_format: PictureFormat = "svg",
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Recognize held-out takes, persons, tasks and sources (Vasilescu; Perera, section 5)."""
    check_csv(csv_file)
    filter = parsed_filter(filter_json)
    drawing = Drawing.prepared(folder=pictures_dir, picture_format=picture_format)
    with judging(context, "recognizing") as (lib, progress):
        found = evaluate.judge_recognition(
            lib,
            filter,
            tuple(method or evaluate.RECOGNIZERS),
            false_accept_rate=false_accept_rate,
            by=by,
            progress=progress,
        )
    report(
        lambda: recognition_document(found),
        lambda: print_tables(found),
        as_json=as_json,
        csv_file=csv_file,
    )
    drawing.draw_all(lambda form: recognition_pictures.all_figures(found, form).items())
