"""The command that searches by pose."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
    source_of,
)
from app.cli.session import open_client
from app.cli.settings import open_library, remote_of
from app.errors import BadField, ConfigurationError
from app.kinedex_error import Place
from app.search.pose.pose_matches import MatchesPerClip

if TYPE_CHECKING:
    from kinedex.types.pose import PoseHits as KinedexPoseHits


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
    fields, pose = filter_of(filter_json), _read_positions(positions)
    options: Any = {"places": places.value, "limit": limit, "filter": fields or None}
    options["include_self"] = include_self
    if query is not None and os.path.lexists(query):
        source = _File(query, skeleton, frame_rate, unit, up_axis, stack)
        hits = _search_file(
            context, source, _Options(time or 0.0, places, limit, fields, include_self)
        )
    else:
        with open_client(context) as client, naming_missing(query or ""):
            hits = client.search.pose(clip_id=query, time=time, positions=pose, **options)
    print_hits(hits, ("time",), as_json=as_json, as_csv=as_csv)


@dataclass(frozen=True, slots=True)
class _File:
    """A motion file that contains the pose, and hints to read it."""

    path: str
    skeleton: Path | None
    frame_rate: float | None
    unit: str | None
    up_axis: str | None
    stack: str | None


@dataclass(frozen=True, slots=True)
class _Options:
    """The options of a search by pose. time: seconds from the start of the file."""

    time: float
    places: MatchesPerClip
    limit: int
    fields: dict[str, Any]
    include_self: bool


def _search_file(context: typer.Context, file: _File, options: _Options) -> KinedexPoseHits:
    """Search with a pose of a file, in the local library: the API takes no file for this search.

    Raises ConfigurationError with --url.
    """
    from app.api.schemas.pose import PoseHits
    from app.services.find.by_pose import PoseQuery, find_pose
    from kinedex.types.pose import PoseHits as KinedexPoseHits

    if remote_of(context) is not None:
        raise ConfigurationError(
            "A service takes no file for a search by pose. Import the file first, and give the id "
            "of its clip; or give --positions."
        )
    with (
        open_library(context) as lib,
        source_of(
            file.path,
            skeleton=file.skeleton,
            frame_rate=file.frame_rate,
            unit=file.unit,
            up_axis=file.up_axis,
            stack=file.stack,
        ) as source,
    ):
        query = PoseQuery(
            source,
            options.time,
            None,
            options.places,
            options.limit,
            options.fields,
            options.include_self,
        )
        found = PoseHits.model_validate(find_pose(lib, query))
    return KinedexPoseHits.from_json(found.model_dump(mode="json"))


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
