"""`kinedex evaluate keyposes`: Table 1 and figures 3 to 6 of Perera 2009 for your own library."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.running import parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, keep_table, report, show_table
from app.cli.options import By, FilterJson, PictureFormat
from app.cli.output import AsJson, progress_bar
from app.cli.settings import open_library
from app.evaluate import KeyposeEvaluation
from app.evaluate import charts as pictures
from app.evaluate.keyposes import pictures as keypose_pictures
from app.evaluate.keyposes.document import keypose_document
from app.models.keyposes.matching import TOLERANCE
from app.models.keyposes.thresholds import USUAL, ThresholdCurve
from app.services.library.library import Library
from app.store.clips.record import ClipRecord

Tolerance = Annotated[
    float, typer.Option(help="Largest distance of a found keypose from the true one, in seconds.")
]
Picture = Annotated[
    Path | None,
    typer.Option(help="Draw precision and recall over T1 and T2: a .svg, .png or .pdf file."),
]
Pictures = Annotated[
    Path | None,
    typer.Option(
        "--pictures",
        help="Draw energies, beats and keyposes of every clip, annotated or not, into this folder.",
    ),
]
PRINTED_STEP = 2
"""Every second value of a curve is printed, so that all fit in one line."""


def keyposes(
    context: typer.Context,
    tolerance: Tolerance = TOLERANCE,
    filter_json: FilterJson = None,
    by: By = None,
    picture: Picture = None,
    pictures_dir: Pictures = None,
    picture_format: PictureFormat = "svg",
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Compare found keyposes with annotated ones (Perera 2009, table 1, figs 3 to 6)."""
    check_csv(csv_file)
    filter = parsed_filter(filter_json)
    drawing = Drawing.prepared(picture, pictures_dir, picture_format)
    with open_library(context) as lib:
        if pictures_dir is not None:
            clips = keypose_pictures.clips_to_draw(lib, filter)
            drawing.draw_all(lambda form: _clip_figures(lib, clips, form))
            typer.echo(f"{len(clips)} pictures are in {pictures_dir}.\n", err=as_json)
            if not evaluate.is_any_annotated(lib, filter):
                return  # only the pictures were possible
        found = evaluate.judge_keyposes(lib, filter, tolerance, by)
    report(
        lambda: keypose_document(found), lambda: _print(found), as_json=as_json, csv_file=csv_file
    )
    drawing.draw_one(lambda form: keypose_pictures.threshold_figure(found, form))


def _clip_figures(
    lib: Library, clips: Sequence[ClipRecord], form: pictures.Format
) -> Iterator[tuple[str, bytes]]:
    """A picture of each clip, named by its id, since clip names may not be valid file names."""
    with progress_bar() as bar:
        for clip in bar.track(clips, description="drawing"):
            yield f"{clip.id}.{form}", keypose_pictures.clip_figure(lib, clip, form)


def _print(found: KeyposeEvaluation) -> None:
    methods = [judged.method for judged in found.methods]
    typer.echo(
        f"Keyposes of {len(found.clips)} clips, correct within {found.tolerance:g} s (table 1):\n"
    )
    show_table(
        "clips",
        ["clip", "true", *(f"{what} {m[0]}" for m in methods for what in ("found", "right"))],
        [
            [clip.name, clip.true]
            + [n for m in methods for n in (clip.counts[m].found, clip.counts[m].correct)]
            for clip in found.clips
        ],
    )
    typer.echo("\n" + ", ".join(f"{method[0]}: {method}" for method in methods) + ".\n")
    show_table(
        "methods",
        ["method", "thresholds", "T1", "T2", "found", "right", "precision", "recall", "F"],
        [row for judged in found.methods for row in _rows(judged, found.recordings)],
    )
    _print_groups(found)
    typer.echo("\nlearned: from all clips; each clip is judged with those of other recordings.\n")
    for judged in found.methods:
        for name, curve, held in (
            ("T1", judged.t1, f"T2 = {judged.learned.t2:g}"),
            ("T2", judged.t2, f"T1 = {judged.learned.t1:g}"),
        ):
            _print_curve(f"{judged.method}, {held}", name, curve)


def _print_groups(found: KeyposeEvaluation) -> None:
    rows = [
        (
            group,
            judged.method,
            one.found,
            one.correct,
            one.precision,
            one.recall,
            one.f,
        )
        for judged in found.methods
        for group, one in found.by_group(judged.method).items()
    ]
    if rows:
        typer.echo("\nThe same for the clips of each group, learned thresholds:\n")
        columns = ("group", "method", "found", "right", "precision", "recall", "F")
        show_table("groups", columns, rows)


def _rows(judged: evaluate.JudgedKeyposes, recordings: int) -> list[list[object]]:
    ways = [("usual", USUAL, judged.usual)]
    if recordings > 1:
        ways.insert(0, ("learned", judged.learned, judged.counts))
    return [
        [judged.method, name, pair.t1, pair.t2, counts.found, counts.correct,
         counts.precision, counts.recall, counts.f]
        for name, pair, counts in ways
    ]  # fmt: skip


def _print_curve(title: str, name: str, curve: ThresholdCurve) -> None:
    """Precision and recall in percent, so that eleven values fit into 80 columns."""
    kept = zip(curve.values, curve.precision, curve.recall, strict=True)
    columns = ["curve", name, "precision", "recall"]
    keep_table(f"over_{name.lower()}", columns, [[title, *row] for row in kept])
    typer.echo(title)
    for label, values, form in (
        (name, curve.values, "{:5.2g}"),
        ("precision", 100 * curve.precision, "{:5.0f}"),
        ("recall", 100 * curve.recall, "{:5.0f}"),
    ):
        typer.echo(f"{label:<10}" + "".join(form.format(v) for v in values[::PRINTED_STEP]))
    typer.echo("")
