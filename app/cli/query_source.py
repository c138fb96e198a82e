"""The query of a command: a motion file, or the id of a stored clip."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from app.errors import BadField, ClipNotFound
from app.kinedex_error import Place

Query = Annotated[str, typer.Argument(help="A motion file, or the id of a stored clip.")]
FrameRate = Annotated[
    float | None,
    typer.Option(help="Frames per second of the file; replaces the rate that it declares."),
]
Skeleton = Annotated[
    Path | None,
    typer.Option(
        exists=True,
        dir_okay=False,
        help="The ASF file that an AMC file needs; default: the one beside it.",
    ),
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

    skeleton: the ASF file of an AMC file; default: the one beside it that goes with its name.
    hints: further arguments; those that are None are left out. Raises BadField if a file cannot be
    read.
    """
    from app.services.imports.skeleton_pairs import skeleton_beside

    given = {name: value for name, value in hints.items() if value is not None}
    if not os.path.lexists(query):
        return {"clip_id": query, **given}
    path = Path(query)
    check_readable(path)
    companion = skeleton or skeleton_beside(path)
    if companion is None:
        return {"file": path, **given}
    check_readable(companion)
    return {"file": path, "skeleton": companion, **given}


def check_readable(path: Path) -> None:
    """Raise BadField if a file that the user named cannot be read."""
    try:
        with path.open("rb"):
            pass
    except OSError as problem:
        message = f"{path} cannot be read: {problem.strerror}"
        raise BadField(message, places=[Place("file", message)]) from None


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
