"""`kinedex evaluate low-dimensional`: section 4 of Perera 2009 for your own library."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.analysis.low_dimensional.eigen_motion import Basis
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.running import judging, parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, report, show_table
from app.cli.options import FilterJson, PictureFormat
from app.cli.output import AsJson
from app.evaluate import LowDimensionalEvaluation
from app.evaluate.low_dimensional import pictures as low_dimensional_pictures
from app.evaluate.low_dimensional.document import low_dimensional_document

Pictures = Annotated[
    Path | None, typer.Option("--pictures", help="Draw figures 7 to 14 into this folder.")
]


def low_dimensional(
    context: typer.Context,
    filter_json: FilterJson = None,
    pictures_dir: Pictures = None,
    picture_format: PictureFormat = "svg",
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Compare keyposes with uniform poses as basis of low-dimensional motion (Perera 2009)."""
    check_csv(csv_file)
    filter = parsed_filter(filter_json)
    drawing = Drawing.prepared(folder=pictures_dir, picture_format=picture_format)
    with judging(context, "reducing") as (lib, progress):
        found = evaluate.judge_low_dimensional(lib, filter, progress)
    report(
        lambda: low_dimensional_document(found),
        lambda: _print(found),
        as_json=as_json,
        csv_file=csv_file,
    )
    drawing.draw_all(lambda form: low_dimensional_pictures.all_figures(found, form).items())


def _print(found: LowDimensionalEvaluation) -> None:
    """Column names end with k for keyposes and u for uniform poses, to fit 80 characters."""
    key, uniform = (basis.value for basis in Basis)
    typer.echo(
        f"{found.clips} clips, each reduced by its own keyposes (k), or as many uniform poses (u);"
        f"\n{found.left_out} others have too few keyposes.\n"
    )
    show_table(
        "dimensions",
        ["K'", "clips", "kept k", "kept u", "mm k", "mm u", "mm least", "k better"],
        [
            [row.dimensions, row.clips, row.variance[key], row.variance[uniform], row.error[key],
             row.error[uniform], row.best, row.keypose_better]
            for row in found.dimensions
        ],
    )  # fmt: skip
    typer.echo(
        "\nkept: variance of the model's own poses (eq. 9, fig. 11); mm: error of the whole "
        "motion;\nleast: by the axes of all frames; k better: share of clips.\n"
    )
    faults = list(found.poses[0].faults)
    show_table(
        "poses",
        ["basis", "frames", "faulty", *(f.replace("_", " ") for f in faults), "clusters"],
        [
            [row.name, row.frames, row.implausible, *(row.faults[f] for f in faults),
             row.silhouette]
            for row in found.poses
        ],
    )  # fmt: skip
    typer.echo(
        "\nAt 3 dimensions; faulty: frames with an impossible pose (figs 13, 14);\n"
        "clusters: silhouette of the model's poses (figs 7, 8). Keyposes cluster better in "
        f"{found.more_clustered:.0%} of the clips.\n"
    )
    if found.groups:
        _print_groups(found)


def _print_groups(found: LowDimensionalEvaluation) -> None:
    key, uniform = (basis.value for basis in Basis)
    typer.echo("Several persons in one model, a clip of each, 3 dimensions (section 4.2):\n")
    show_table(
        "groups",
        ["task", "who", "K", "kept k", "kept u", "mm k", "mm u", "gap k", "gap u"],
        [
            [row.task, row.persons, row.poses, row.variance[key], row.variance[uniform],
             row.error[key], row.error[uniform], row.gap[key], row.gap[uniform]]
            for row in found.groups
        ],
    )  # fmt: skip
    typer.echo("\ngap: the silhouette minus that of poses without clusters.")
