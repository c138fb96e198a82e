"""Search by pose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.find import filter_of
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_json, print_table
from app.cli.query_source import FrameRate, Skeleton, Stack, Unit, source_of
from app.cli.settings import open_library
from app.errors import BadField, Place
from app.search.pose.pose_places import Places


def search_pose(
    context: typer.Context,
    query: Annotated[
        str | None, typer.Argument(help="A motion file, or the id of a stored clip.")
    ] = None,
    time: Annotated[float | None, typer.Option(help="Seconds: which of its poses.")] = None,
    positions: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="A JSON file with 13 [x, y, z], in place of a motion."
        ),
    ] = None,
    places: Annotated[
        Places, typer.Option(help="best: one hit a clip; all: each place where it is taken.")
    ] = Places.BEST,
    limit: Annotated[int, typer.Option(help="Most hits, 1 to 1000.")] = 10,
    filter_json: FilterJson = None,
    skeleton: Skeleton = None,
    frame_rate: FrameRate = None,
    unit: Unit = None,
    stack: Stack = None,
    as_json: AsJson = False,
) -> None:
    """Find the clips that take a pose, and when they do."""
    from app.services.find.by_pose import PoseQuery, find_pose

    if (query is None) == (positions is None):
        raise typer.BadParameter("give either a file or clip id with --time, or --positions")
    if query is not None and time is None:
        raise typer.BadParameter("--time is needed: the seconds at which the pose is taken")
    wanted, pose = filter_of(filter_json), _read(positions)
    with open_library(context) as lib:
        if query is None:
            hits = find_pose(lib, PoseQuery(None, time, pose, places, limit, wanted))
        else:
            with source_of(
                query, skeleton=skeleton, frame_rate=frame_rate, unit=unit, stack=stack
            ) as source:
                hits = find_pose(lib, PoseQuery(source, time, None, places, limit, wanted))
    if as_json:
        from app.api.schemas.pose import PoseHits

        print_json(PoseHits.model_validate(hits).model_dump(mode="json"))
        return
    columns = ("rank", "score", "time", "name", "person", "task", "id")
    rows = [
        (h.rank, h.score, h.time, h.clip.name, h.clip.person, h.clip.task, h.clip.id)
        for h in hits.items
    ]
    print_table(columns, rows)


def _read(positions: Path | None) -> list[Any] | None:
    if positions is None:
        return None
    try:
        found = json.loads(positions.read_text())
    except ValueError as problem:
        places = [Place("positions", str(problem))]
        raise BadField("The positions are not JSON.", places=places) from None
    if not isinstance(found, list):
        raise BadField(
            "The positions must be a JSON array.", places=[Place("positions", "no array")]
        )
    return found
