"""The command that searches by pose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.hits import print_hits
from app.cli.options import FilterJson, IncludeSelf, filter_of
from app.cli.output import AsCsv, AsJson
from app.cli.query_source import (
    FrameRate,
    Skeleton,
    Stack,
    Unit,
    UpAxis,
    naming_missing,
    query_of,
)
from app.cli.session import open_client
from app.errors import BadField
from app.kinedex_error import Place
from app.search.pose.pose_matches import MatchesPerClip


def search_pose(
    context: typer.Context,
    query: Annotated[
        str | None, typer.Argument(help="A motion file, or the id of a stored clip.")
    ] = None,
    time: Annotated[
        float | None, typer.Option(help="The time of the pose in the motion, in seconds.")
    ] = None,
    positions: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="A JSON file with 13 [x, y, z], instead of a motion."
        ),
    ] = None,
    places: Annotated[
        MatchesPerClip,
        typer.Option(help="best: one hit for each clip; all: each time of the pose."),
    ] = MatchesPerClip.BEST,
    limit: Annotated[int, typer.Option(help="Largest number of hits, 1 to 1000.")] = 10,
    filter_json: FilterJson = None,
    include_self: IncludeSelf = False,
    skeleton: Skeleton = None,
    frame_rate: FrameRate = None,
    unit: Unit = None,
    up_axis: UpAxis = None,
    stack: Stack = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Find the clips that contain a pose, and the time of the pose in each."""
    if (query is None) == (positions is None):
        raise typer.BadParameter("give either a file or clip id with --time, or --positions")
    if query is not None and time is None:
        raise typer.BadParameter("--time is needed: the time of the pose in seconds")
    hints: dict[str, Any] = {
        "time": time,
        "places": places.value,
        "limit": limit,
        "filter": filter_of(filter_json) or None,
        "include_self": include_self,
        "frame_rate": frame_rate,
        "unit": unit,
        "up_axis": up_axis,
        "stack": stack,
    }
    pose = _read_positions(positions)
    with open_client(context) as client, naming_missing(query or ""):
        if query is None:
            hits = client.search.pose(positions=pose, **hints)
        else:
            hits = client.search.pose(**query_of(query, skeleton=skeleton, **hints))
    print_hits(hits, ("time",), as_json=as_json, as_csv=as_csv)


def _read_positions(path: Path | None) -> list[Any] | None:
    if path is None:
        return None
    try:
        positions = json.loads(path.read_text())
    except ValueError as problem:
        places = [Place("positions", str(problem))]
        raise BadField("The positions are not JSON.", places=places) from None
    if not isinstance(positions, list):
        raise BadField(
            "The positions must be a JSON array.", places=[Place("positions", "no array")]
        )
    return positions
