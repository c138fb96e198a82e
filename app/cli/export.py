"""The command that exports a clip as a file for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from app.analysis.low_dimensional.eigen_motion import Basis
from app.cli.files import write_whole
from app.cli.output import AsJson, print_json
from app.cli.session import open_client
from app.cli.settings import open_library, remote_of
from app.errors import BadField, Place
from app.services.views.export_format import ExportFormat, ExportSkeleton


def export(
    context: typer.Context,
    clip_id: Annotated[str, typer.Argument(help="The id of a stored clip.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="File to write; default: the clip's name, in this folder."
        ),
    ] = None,
    format: Annotated[
        ExportFormat | None, typer.Option(help="Default: the suffix of --output, else bvh.")
    ] = None,
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
    as_json: AsJson = False,
) -> None:
    """Export a clip as BVH, GLB, NPZ or CSV."""
    from app.services.views import export as exporting
    from app.services.views.low_dimensional import Reduction

    target = format or _format_by_suffix(output)
    if remote_of(context) is not None:
        options = {"fps": fps, "skeleton": skeleton.value, "dimensions": dimensions}
        options |= {"basis": basis.value} if dimensions is not None else {}
        _export_from_service(context, clip_id, target, output, options, as_json=as_json)
        return
    with open_library(context) as lib:
        reduction = None if dimensions is None else Reduction(dimensions, basis)
        file = exporting.export(
            lib, clip_id, target, fps=fps, skeleton=skeleton, reduction=reduction
        )
        path = output or Path(file.file_name)
        size = write_whole(path, file.blocks)
    _print_file(path, target, size, as_json=as_json)


def _export_from_service(
    context: typer.Context,
    clip_id: str,
    target: ExportFormat,
    output: Path | None,
    options: dict[str, Any],
    *,
    as_json: bool,
) -> None:
    """Export a clip of the service at --url. Raises kinedex.KinedexError, BadField."""
    with open_client(context) as client:
        content = client.clips.export(clip_id, target.value, **options)
        path = output or Path(f"{_file_name(client.clips.get(clip_id).name)}.{target.value}")
    size = write_whole(path, [content])
    _print_file(path, target, size, as_json=as_json)


def _file_name(name: str) -> str:
    """`name` as a valid file name on every system: other characters become "_"."""
    return "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in name).strip(" .")[:100]


def _print_file(path: Path, target: ExportFormat, size: int, *, as_json: bool) -> None:
    if as_json:
        print_json({"path": str(path), "format": target.value, "bytes": size})
    else:
        typer.echo(f"{path}: {size} bytes")


def _format_by_suffix(output: Path | None) -> ExportFormat:
    """The format that the suffix of `output` names; BVH without a path. Raises BadField."""
    if output is None:
        return ExportFormat.BVH
    try:
        return ExportFormat(output.suffix.lower().removeprefix("."))
    except ValueError:
        formats = ", ".join(ExportFormat)
        message = f"must end with one of {formats}, unless --format is given"
        raise BadField(f"output: {message}", places=[Place("output", message)]) from None
