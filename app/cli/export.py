"""The command that exports clips as files for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from app.analysis.low_dimensional.eigen_motion import Basis
from app.cli.export_sources import Source, open_source
from app.cli.files import write_whole
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_json, progress_bar
from app.errors import BadField
from app.kinedex_error import Place
from app.services.views.export_format import (
    ExportContent,
    ExportFormat,
    ExportJoints,
    ExportSkeleton,
    ExportUnit,
)


def _print_definitions(requested: bool) -> None:
    if requested:
        from app.analysis.angles import definitions as angles
        from app.analysis.gait import parameters as gait

        typer.echo(f"Joint angles:\n\n{angles.explained()}\n")
        typer.echo(f"Gait parameters of a stride:\n\n{gait.explained()}")
        raise typer.Exit


def export(
    context: typer.Context,
    clip_ids: Annotated[
        list[str] | None,
        typer.Argument(metavar="[CLIP_ID]...", help="The ids of stored clips."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="File to write, or folder; several clips need a folder, which is made. Default: "
            "the clip's name, in this folder.",
        ),
    ] = None,
    format: Annotated[
        ExportFormat | None,
        typer.Option(help="Default: by the ending of --output, csv with --content, else bvh."),
    ] = None,
    content: Annotated[
        ExportContent | None, typer.Option(help="The table of a CSV file; default: positions.")
    ] = None,
    unit: Annotated[
        ExportUnit | None,
        typer.Option(help="Of lengths; default: cm for BVH, mm for C3D and TRC, else m."),
    ] = None,
    joints: Annotated[
        ExportJoints,
        typer.Option(help="All joints by their own names, or those with a role, by role."),
    ] = ExportJoints.ALL,
    fps: Annotated[
        float | None,
        typer.Option(
            help="Frames per second, 1 to 1000 (resampled by time); default: the clip's rate."
        ),
    ] = None,
    skeleton: Annotated[
        ExportSkeleton, typer.Option(help="The clip's own joints, or one body for all clips.")
    ] = ExportSkeleton.OWN,
    dimensions: Annotated[
        int | None, typer.Option(help="Reduce the motion to this many dimensions of its keyposes.")
    ] = None,
    basis: Annotated[
        Basis, typer.Option(help="With --dimensions: keyposes, or as many poses at equal times.")
    ] = Basis.KEYPOSE,
    filter_json: FilterJson = None,
    _definitions: Annotated[
        bool,
        typer.Option(
            "--definitions",
            callback=_print_definitions,
            is_eager=True,
            help="Print the definition and the sign of each joint angle and gait parameter.",
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Export clips as BVH, GLB, NPZ, CSV, C3D (Z up) or TRC (for OpenSim).

    With --filter instead of ids, all ready clips that pass it. A clip that cannot be exported, as
    one without walking with --content gait, is named on standard error, and the others go on.

    Tables of a CSV file (--content): positions, a row a frame. angles, a row a frame: joint angles
    in degrees by the ISB's conventions. segments, a row from keypose to keypose. gait, a row a
    parameter: cadence, stride length, stance, ... with mean and standard deviation by side, and
    symmetry. strides, a row a stride. cycles: joint angles over the gait cycle, 0 to 100 %, mean
    and standard deviation by side.
    """
    from app.services.views.low_dimensional import Reduction

    is_many = filter_json is not None or len(clip_ids or ()) > 1
    options = {
        "format": format or _usual_format(None if is_many else output, content),
        "content": content,
        "unit": unit,
        "joints": joints,
        "skeleton": skeleton,
        "fps": fps,
        "reduction": None if dimensions is None else Reduction(dimensions, basis),
    }
    with open_source(context) as source:
        if is_many or not clip_ids:
            ids = _chosen(source, clip_ids, filter_json)
            written = _write_many(source, ids, output or Path(), options)
        else:
            written = _write_one(source, clip_ids[0], output, options)
    _print_written(written, output, is_many=is_many, as_json=as_json)


def _print_written(
    written: dict[str, Any], output: Path | None, *, is_many: bool, as_json: bool
) -> None:
    """Print the paths and sizes. Ends the program with 1 if no clip of many could be exported."""
    if as_json:
        print_json(written)
    elif not is_many:
        typer.echo(f"{written['path']}: {written['bytes']} bytes")
    else:
        typer.echo(f"{len(written['files'])} files are in {output or Path()}.")
    if is_many and not written["files"]:
        raise typer.Exit(1)


def _made_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        message = f"{folder} is no folder and cannot be made: {problem.strerror}"
        raise _bad("output", message) from None


def _usual_format(output: Path | None, content: ExportContent | None) -> ExportFormat:
    if content is not None:
        return ExportFormat.CSV
    if output is None or output.is_dir():
        return ExportFormat.BVH
    try:
        return ExportFormat(output.suffix.lower().removeprefix("."))
    except ValueError:
        known = ", ".join(ExportFormat)
        raise _bad("output", f"must end with one of {known}, unless --format is given") from None


def _chosen(
    source: Source, clip_ids: Sequence[str] | None, filter_json: str | None
) -> Sequence[str]:
    """The ids that are given, or those of the ready clips that pass the filter."""
    if clip_ids and filter_json is not None:
        raise _bad("filter", "goes without ids of clips")
    if clip_ids:
        return clip_ids
    if filter_json is None:
        raise _bad("clip_ids", "expected the id of a clip, or --filter")
    return source.ready_ids(filter_json)


def _write_one(
    source: Source, clip_id: str, output: Path | None, options: dict[str, Any]
) -> dict[str, Any]:
    file = source.one(clip_id, options)
    path = output or Path(file.file_name)
    if path.is_dir():
        path = path / file.file_name
    size = write_whole(path, file.blocks)
    return {"path": str(path), "format": options["format"].value, "bytes": size}


def _write_many(
    source: Source, clip_ids: Sequence[str], folder: Path, options: dict[str, Any]
) -> dict[str, Any]:
    """Write a file for each clip into the folder, and name those without one."""
    _made_folder(folder)
    files, left_out = [], []
    with progress_bar() as bar:
        each = source.each(clip_ids, options)
        for one in bar.track(each, total=len(clip_ids), description="exporting"):
            if one.file is None:
                left_out.append({"clip_id": one.clip_id, "reason": one.reason})
                typer.echo(f"{one.clip_id}: {one.reason}", err=True)
                continue
            path = folder / one.file.file_name
            size = write_whole(path, one.file.blocks)
            files.append({"clip_id": one.clip_id, "path": str(path), "bytes": size})
    return {"format": options["format"].value, "files": files, "left_out": left_out}


def _bad(field: str, message: str) -> BadField:
    return BadField(f"{field}: {message}", places=[Place(field, message)])
