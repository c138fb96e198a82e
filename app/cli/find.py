"""Search and recognise."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import FilterJson
from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library
from app.errors import BadField, ClipNotFound, Place
from app.search.example.methods import Method

if TYPE_CHECKING:
    from app.api.schemas.recognition import Answer
    from app.services.find.hits import Hits
    from app.store.files.files import Readable

Query = Annotated[str, typer.Argument(help="A motion file, or the id of a stored clip.")]
FrameRate = Annotated[float | None, typer.Option(help="Of a file: overrides what it declares.")]
Skeleton = Annotated[
    Path | None,
    typer.Option(exists=True, dir_okay=False, help="The ASF file that an AMC file needs."),
]
Stack = Annotated[
    str | None, typer.Option(help="Of an FBX file: the animation stack; default the longest.")
]
Unit = Annotated[str | None, typer.Option(help="Of a file: m, cm, mm, in, or metres per unit.")]

ASK_BY_WORDS = " Words go behind --words."


def search(
    context: typer.Context,
    query: Annotated[
        str | None, typer.Argument(help="A motion file, or the id of a stored clip.")
    ] = None,
    words: Annotated[
        list[str] | None,
        typer.Option(
            "--words", help="Words or a sentence; -word leaves out; may be given several times."
        ),
    ] = None,
    method: Annotated[Method, typer.Option(help="Of a search by example.")] = Method.FUSED,
    scope: Annotated[
        str,
        typer.Option(help="clips; windows: parts of clips; segments: steps between keyposes."),
    ] = "clips",
    segment: Annotated[
        int | None, typer.Option(help="With --scope segments: a clip's step, counted from 0.")
    ] = None,
    mode: Annotated[str, typer.Option(help="Of a search by words: default or cca.")] = "default",
    start: Annotated[float | None, typer.Option(help="Seconds: search by a part.")] = None,
    end: Annotated[float | None, typer.Option(help="Seconds: where the part ends.")] = None,
    limit: Annotated[int, typer.Option(help="Most hits, 1 to 1000.")] = 10,
    filter_json: FilterJson = None,
    skeleton: Skeleton = None,
    frame_rate: FrameRate = None,
    unit: Unit = None,
    stack: Stack = None,
    as_json: AsJson = False,
) -> None:
    """Find motions like one (a file or a stored clip), or motions for words."""
    from app.services.find import find

    if (query is None) == (not words):
        raise typer.BadParameter("give either a file or clip id, or --words")
    if words and scope != "clips":
        raise typer.BadParameter("--scope goes with a file or clip id, not with --words")
    wanted = filter_of(filter_json)
    with open_library(context) as lib:
        if words:
            asked = find.WordQuery(words, mode, limit, wanted)
            hits = find.find_words(lib, asked)
        else:
            with (
                content_of(query, ASK_BY_WORDS) as (clip_id, content),
                companion_of(skeleton) as asf,
            ):
                hits = find.find_motion(
                    lib,
                    find.MotionQuery(
                        clip_id=clip_id,
                        content=content,
                        start=start,
                        end=end,
                        method=method,
                        limit=limit,
                        filter=wanted,
                        scope=scope,
                        segment=segment,
                        skeleton=asf,
                        frame_rate=frame_rate,
                        unit=unit,
                        stack=stack,
                    ),
                )
    _show(hits, as_json, by_words=bool(words), parts=scope != "clips")


def recognize(
    context: typer.Context,
    query: Query,
    known_person: Annotated[str | None, typer.Option(help="The person, if known.")] = None,
    known_task: Annotated[str | None, typer.Option(help="The task, if known.")] = None,
    method: Annotated[
        str, typer.Option(help="default, multilinear, signatures or perera.")
    ] = "default",
    skeleton: Skeleton = None,
    frame_rate: FrameRate = None,
    unit: Unit = None,
    stack: Stack = None,
    as_json: AsJson = False,
) -> None:
    """Tell who it is, what they do, and in which words."""
    from app.api.schemas.recognition import Recognition
    from app.services.recognition import recognize

    with (
        open_library(context) as lib,
        content_of(query) as (clip_id, content),
        companion_of(skeleton) as asf,
    ):
        found = recognize.recognize(
            lib,
            recognize.RecognizeQuery(
                clip_id=clip_id,
                content=content,
                known_person=known_person,
                known_task=known_task,
                method=method,
                skeleton=asf,
                frame_rate=frame_rate,
                unit=unit,
                stack=stack,
            ),
        )
    answer = Recognition.of(found)
    if as_json:
        print_json(answer.model_dump(mode="json"))
        return
    told = {"person": answer.person, "task": answer.task}
    print_table(("", "answer", "score"), [(n, _told(a), a.score) for n, a in told.items()])
    print_table(("word", "score"), [(one.word, one.score) for one in answer.words])


def _told(answer: Answer) -> str:
    if answer.known and answer.label is not None:
        return answer.label
    nearest = answer.candidates[0].label if answer.candidates else "nothing"
    return f"unknown (nearest: {nearest})"


def filter_of(text: str | None) -> dict[str, Any]:
    """A filter as it was typed, in JSON. Raises BadField."""
    try:
        wanted = json.loads(text) if text else {}
    except ValueError as problem:
        raise BadField("The filter is not JSON.", places=[Place("filter", str(problem))]) from None
    if not isinstance(wanted, dict):
        raise BadField("The filter must be a JSON object.", places=[Place("filter", str(text))])
    return wanted


@contextmanager
def content_of(query: str | None, advice: str = "") -> Iterator[tuple[str | None, Readable | None]]:
    """A file's content where there is such a file, else the query as a clip's id; advice: what
    to say besides where it is neither.

    Raises BadField for what cannot be read, ClipNotFound where it is neither.
    """
    if query is None or not os.path.lexists(query):
        try:
            yield query, None
        except ClipNotFound as problem:
            detail = f"There is no file {query!r}, and no clip has that id.{advice}"
            raise ClipNotFound(detail, places=problem.places) from None
        return
    with opened(Path(query)) as content:
        yield None, content


@contextmanager
def opened(path: Path) -> Iterator[Readable]:
    """A file that a user named. Raises BadField where it cannot be read."""
    try:
        content = path.open("rb")
    except OSError as problem:
        message = f"{path} cannot be read: {problem.strerror}"
        raise BadField(message, places=[Place("file", message)]) from None
    with content:
        yield content


@contextmanager
def companion_of(skeleton: Path | None) -> Iterator[Readable | None]:
    """The content of a file that goes with another, where one is given."""
    if skeleton is None:
        yield None
        return
    with opened(skeleton) as content:
        yield content


def _show(hits: Hits, as_json: bool, *, by_words: bool, parts: bool) -> None:
    if as_json:
        from app.api.schemas.search import MotionHits, WordHits

        answer = WordHits.of(hits) if by_words else MotionHits.of(hits)
        print_json(answer.model_dump(mode="json"))
        return
    print_table(
        ("rank", "score", *(("start", "end") if parts else ()), "name", "person", "task", "id"),
        [
            (
                hit.rank,
                hit.score,
                *((hit.start, hit.end) if parts else ()),
                hit.clip.name,
                hit.clip.person,
                hit.clip.task,
                hit.clip.id,
            )
            for hit in hits.items
        ],
    )
    if hits.unknown_words:
        typer.echo(f"No clip carries: {', '.join(hits.unknown_words)}", err=True)
