"""The query of a command: a motion file, or the id of a stored clip."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.errors import BadField, ClipNotFound
from app.kinedex_error import Place

if TYPE_CHECKING:
    from app.services.find.query_source import QuerySource
    from app.store.files.files import Readable

Query = Annotated[str, typer.Argument(help="A motion file, or the id of a stored clip.")]
FrameRate = Annotated[
    float | None,
    typer.Option(help="Frames per second of the file; replaces the rate that it declares."),
]
Skeleton = Annotated[
    Path | None,
    typer.Option(exists=True, dir_okay=False, help="The ASF file that an AMC file needs."),
]
Stack = Annotated[
    str | None, typer.Option(help="Animation stack of an FBX file; default: the longest.")
]
Unit = Annotated[
    str | None, typer.Option(help="Unit of the file: m, cm, mm, in, or meters per unit.")
]

UpAxis = Annotated[
    str | None, typer.Option(help="Axis of the file that points up: x, y, z, -x, -y or -z.")
]


def query_of(query: str, *, skeleton: Path | None = None, **hints: Any) -> dict[str, Any]:
    """The arguments of a call of the client: the file at the path `query`, else the clip's id.

    skeleton: an ASF file. hints: further arguments; those that are None are left out. Raises
    BadField if a file cannot be read.
    """
    given = {name: value for name, value in hints.items() if value is not None}
    if not os.path.lexists(query):
        return {"clip_id": query, **given}
    files = {"file": Path(query), "skeleton": skeleton}
    for path in files.values():
        with _opened(path):
            pass
    return {**{name: path for name, path in files.items() if path is not None}, **given}


@contextmanager
def naming_missing(query: str, advice: str = "") -> Iterator[None]:
    """Say that there is no file either, if there is no clip with the id `query`.

    advice: a sentence that is added to the message. Raises ClipNotFound instead.
    """
    from kinedex import KinedexError

    try:
        yield
    except KinedexError as problem:
        if problem.code != ClipNotFound.code or os.path.lexists(query):
            raise
        detail = f"There is no file {query!r}, and no clip has that id.{advice}"
        raise ClipNotFound(detail) from None


@contextmanager
def source_of(
    query: str,
    *,
    start: float | None = None,
    end: float | None = None,
    skeleton: Path | None = None,
    frame_rate: float | None = None,
    unit: str | None = None,
    up_axis: str | None = None,
    stack: str | None = None,
    advice: str = "",
) -> Iterator[QuerySource]:
    """The query of a command: the file at the path `query`, else the clip with that id.

    Its files are open within the block. start, end: seconds. skeleton: an ASF file. advice: a
    sentence that is added to the message if `query` is neither a file nor a clip. Raises BadField
    if a file cannot be read, and ClipNotFound (from the search) if there is no file and no clip.
    """
    from app.services.find.query_source import QuerySource

    is_file = os.path.lexists(query)
    with (
        _opened(Path(query) if is_file else None) as content,
        _opened(skeleton) as skeleton_content,
    ):
        source = QuerySource(
            clip_id=None if is_file else query,
            content=content,
            start=start,
            end=end,
            skeleton=skeleton_content,
            frame_rate=frame_rate,
            unit=unit,
            up_axis=up_axis,
            stack=stack,
        )
        try:
            yield source
        except ClipNotFound as problem:
            if is_file:
                raise
            detail = f"There is no file {query!r}, and no clip has that id.{advice}"
            raise ClipNotFound(detail, places=problem.places) from None


@contextmanager
def _opened(path: Path | None) -> Iterator[Readable | None]:
    """Open a file that the user named; None without a path. Raises BadField."""
    try:
        opened = nullcontext() if path is None else path.open("rb")
    except OSError as problem:
        message = f"{path} cannot be read: {problem.strerror}"
        raise BadField(message, places=[Place("file", message)]) from None
    with opened as content:
        yield content
