"""The command that searches by pose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.find import filter_of
from app.cli.options import FilterJson, IncludeSelf
from app.cli.output import AsJson, print_json, print_table
from app.cli.query_source import FrameRate, Skeleton, Stack, Unit, UpAxis, source_of
from app.cli.settings import open_library
from app.errors import BadField, Place
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
) -> None:
    """Find the clips that contain a pose, and the time of the pose in each."""
    from app.services.find.by_pose import PoseQuery, find_pose

    if (query is None) == (positions is None):
        raise typer.BadParameter("give either a file or clip id with --time, or --positions")
    if query is not None and time is None:
        raise typer.BadParameter("--time is needed: the time of the pose in seconds")
    fields, pose = filter_of(filter_json), _read_positions(positions)
    with open_library(context) as lib:
        if query is None:
            hits = find_pose(lib, PoseQuery(None, time, pose, places, limit, fields))
        else:
            with source_of(
                query,
                skeleton=skeleton,
                frame_rate=frame_rate,
                unit=unit,
                up_axis=up_axis,
                stack=stack,
            ) as source:
                hits = find_pose(
                    lib, PoseQuery(source, time, None, places, limit, fields, include_self)
                )
    if as_json:
        from app.api.schemas.pose import PoseHits

        print_json(PoseHits.model_validate(hits).model_dump(mode="json"))
        return
    columns = ("rank", "score", "time", "name", "person", "task", "id")
    rows = [
        (h.rank, h.score, h.time, h.clip.full_name, h.clip.person, h.clip.task, h.clip.id)
        for h in hits.items
    ]
    print_table(columns, rows)


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
