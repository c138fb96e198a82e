"""`kinedex evaluate retrieval`: the tables and figures of Sun 2011 for your own library."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from app import evaluate
from app.cli.evaluate.confusion_table import print_confusion
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.running import judging, parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, report, show_table
from app.cli.options import By, FilterJson, PictureFormat
from app.cli.output import AsJson, print_text
from app.evaluate import RetrievalEvaluation, VolumeEvaluation
from app.evaluate import charts as pictures
from app.evaluate.retrieval import pictures as retrieval_pictures
from app.evaluate.retrieval.document import retrieval_document
from app.search.example.methods import Method

Classes = Annotated[
    str | None,
    typer.Option(help="Tasks of table 1, like walk,run,jump,kick; default: the four largest."),
]
Methods = Annotated[
    list[Method] | None, typer.Option("--method", help="Judge this method; may be repeated.")
]
K = Annotated[int, typer.Option("--k", min=1, help="Number of nearest clips to judge.")]
Eta = Annotated[
    float,
    typer.Option(
        min=0.0, help="Judge the MSV methods with this threshold too, in body lengths, as 0.3."
    ),
]
Queries = Annotated[
    int, typer.Option(min=1, help="Largest number of query clips, evenly from the tasks.")
]
Picture = Annotated[
    Path | None, typer.Option(help="Draw the confusion matrices: a .svg, .png or .pdf file.")
]
Pictures = Annotated[
    Path | None,
    typer.Option("--pictures", help="Draw all figures of the paper into this folder."),
]

_GROUP_COLUMNS = (
    *("method", "queries", "nearest", "precision_at_4", "precision_at_20"),
    "mean_average_precision",
)
"""The figures in the table of groups."""


def retrieval(
    context: typer.Context,
    classes: Classes = None,
    method: Methods = None,
    k: K = evaluate.K,
    eta: Eta = 0.0,
    queries: Queries = evaluate.MAX_QUERIES,
    filter_json: FilterJson = None,
    by: By = None,
    picture: Picture = None,
    pictures_dir: Pictures = None,
    picture_format: PictureFormat = "svg",
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Search with each clip as the query; clips of the same task are relevant (Sun 2011)."""
    check_csv(csv_file)
    filter = parsed_filter(filter_json)
    names = None if classes is None else [name.strip() for name in classes.split(",")]
    drawing = Drawing.prepared(picture, pictures_dir, picture_format)
    with judging(context, "searching") as (lib, progress):
        found = evaluate.judge_retrieval(
            lib,
            filter,
            method or evaluate.JUDGED,
            classes=names,
            k=k,
            threshold=eta,
            max_queries=queries,
            by=by,
            progress=progress,
        )
        volumes = evaluate.judge_volumes(lib, filter, classes=names, threshold=eta)
    report(
        lambda: retrieval_document(found, volumes),
        lambda: _print(found, volumes),
        as_json=as_json,
        csv_file=csv_file,
    )
    drawing.draw_one(lambda form: _confusions(found, form))
    drawing.draw_all(lambda form: retrieval_pictures.all_figures(found, volumes, form).items())


def _confusions(found: RetrievalEvaluation, form: pictures.Format) -> bytes:
    return retrieval_pictures.confusion_figure(found, retrieval_pictures.shown_methods(found), form)


def _print(found: RetrievalEvaluation, volumes: VolumeEvaluation) -> None:
    queries = found.methods[0].figures.queries if found.methods else 0
    typer.echo(
        f"{queries} clips are queries for the others of their task, among {found.mixture}:\n"
    )
    show_table(
        "figures",
        ["method", "1-NN", "P@4", "P@20", "MAP"],
        [list(asdict(judged.figures).values())[:5] for judged in found.methods],
    )
    _print_groups(found)
    typer.echo(f"\nTrue-positive rates among the {found.k} nearest in the mixture (table 1):\n")
    show_table(
        "true_positive_rates",
        ["method", *found.chosen, "overall"],
        [
            [judged.figures.method, *judged.rates.tolist(), judged.overall]
            for judged in found.methods
        ],
    )
    for judged in found.methods:
        if judged.figures.method in retrieval_pictures.shown_methods(found):
            typer.echo(
                f"\nTrue classes, and classes of the {found.k} nearest clips by"
                f" {judged.figures.method}, % (figure 8):\n"
            )
            print_confusion(found.classes, judged.confusion, f"confusion_{judged.figures.method}")
            typer.echo(f"Overall mean (of the diagonal): {100 * judged.overall_confusion:.1f} %")
    print_text("\n" + "\n".join(_remarks(found, volumes)))


def _print_groups(found: RetrievalEvaluation) -> None:
    rows = [
        (group, *(getattr(figures, name) for name in _GROUP_COLUMNS))
        for judged in found.methods
        for group, figures in judged.by_group.items()
    ]
    if rows:
        typer.echo("\nThe same for the queries of each group:\n")
        columns = ["group", "method", "queries", "1-NN", "P@4", "P@20", "MAP"]
        show_table("groups", columns, rows)


def _remarks(found: RetrievalEvaluation, volumes: VolumeEvaluation) -> list[str]:
    compression = volumes.compression
    settings = f"q = {volumes.q}, eta = {volumes.threshold:g}"
    remarks = [
        f"A task with fewer than {found.k} other clips is judged by as many nearest clips.",
        f"Rank-1 factors ({settings}) of {len(volumes.iterations)} clips of these tasks:"
        f" {volumes.converged} converged, in {np.median(volumes.iterations):.0f} iterations"
        f" (median; {max(volumes.iterations)} at most).",
        f"Compression ratio (section 5.3): {compression.formula:.4f} by the formula,"
        f" {compression.measured:.4f} as stored (q = 2, eta = 0), of {compression.clips} clips"
        f" with {compression.frames} frames.",
    ]
    if found.alone:
        remarks.append(
            f"{found.alone} clips are the only recording of their task, so they were no queries."
        )
    if found.unlabeled:
        remarks.append(f"{found.unlabeled} clips carry no task and were left out.")
    return remarks
