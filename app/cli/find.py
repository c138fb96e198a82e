"""The commands that search by example or by words, and that recognize a motion."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import FilterJson, IncludeSelf
from app.cli.output import AsJson, print_json, print_table
from app.cli.query_source import FrameRate, Query, Skeleton, Stack, Unit, UpAxis, source_of
from app.cli.settings import open_library
from app.errors import BadField, Place
from app.search.example.methods import Method

if TYPE_CHECKING:
    from app.api.schemas.recognition import Answer
    from app.services.find.hits import Hits

ADVICE = " Use --words to search by words."


def search(
    context: typer.Context,
    query: Annotated[
        str | None, typer.Argument(help="A motion file, or the id of a stored clip.")
    ] = None,
    words: Annotated[
        list[str] | None,
        typer.Option(
            "--words",
            help="Words or a sentence; -word excludes clips with that word; may be repeated.",
        ),
    ] = None,
    method: Annotated[Method, typer.Option(help="Method of a search by example.")] = Method.FUSED,
    scope: Annotated[
        str,
        typer.Option(
            help="Search for: clips; windows (parts of clips); segments (between keyposes)."
        ),
    ] = "clips",
    segment: Annotated[
        int | None,
        typer.Option(help="With --scope segments: the segment of the clip, counted from 0."),
    ] = None,
    mode: Annotated[
        str, typer.Option(help="Mode of a search by words: default or cca.")
    ] = "default",
    start: Annotated[
        float | None, typer.Option(help="Search with a part of the motion: its start in seconds.")
    ] = None,
    end: Annotated[float | None, typer.Option(help="The end of that part in seconds.")] = None,
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
    """Find motions that are similar to a file or a stored clip, or motions for words."""
    from app.services.find import find
    from app.services.find.queries import MotionQuery, WordQuery

    if (query is None) == (not words):
        raise typer.BadParameter("give either a file or clip id, or --words")
    if words and scope != "clips":
        raise typer.BadParameter("--scope goes with a file or clip id, not with --words")
    fields = filter_of(filter_json)
    with open_library(context) as lib:
        if words:
            hits = find.find_words(lib, WordQuery(words, mode, limit, fields))
        elif query is not None:
            with source_of(
                query,
                start=start,
                end=end,
                skeleton=skeleton,
                frame_rate=frame_rate,
                unit=unit,
                up_axis=up_axis,
                stack=stack,
                advice=ADVICE,
            ) as source:
                motion_query = MotionQuery(
                    source, method, limit, fields, scope, segment, include_self
                )
                hits = find.find_motion(lib, motion_query)
    _print_hits(hits, as_json, by_words=bool(words), with_times=scope != "clips")


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
    up_axis: UpAxis = None,
    stack: Stack = None,
    as_json: AsJson = False,
) -> None:
    """Recognize the person and the task of a motion, and describe it with words."""
    from app.api.schemas.recognition import Recognition
    from app.services.recognition import recognize

    with (
        open_library(context) as lib,
        source_of(
            query,
            skeleton=skeleton,
            frame_rate=frame_rate,
            unit=unit,
            up_axis=up_axis,
            stack=stack,
        ) as source,
    ):
        request = recognize.RecognizeQuery(source, known_person, known_task, method)
        recognized = recognize.recognize(lib, request)
    answer = Recognition.of(recognized)
    if as_json:
        print_json(answer.model_dump(mode="json"))
        return
    rows = [
        (name, _answer_text(one), one.score)
        for name, one in (("person", answer.person), ("task", answer.task))
    ]
    print_table(("", "answer", "score"), rows)
    print_table(("word", "score"), [(one.word, one.score) for one in answer.words])


def _answer_text(answer: Answer) -> str:
    """The label, or "unknown" with the nearest label."""
    if answer.known and answer.label is not None:
        return answer.label
    nearest = answer.candidates[0].label if answer.candidates else "nothing"
    return f"unknown (nearest: {nearest})"


def filter_of(text: str | None) -> dict[str, Any]:
    """The fields of a filter in a JSON text; empty without a text. Raises BadField."""
    try:
        fields = json.loads(text) if text else {}
    except ValueError as problem:
        raise BadField("The filter is not JSON.", places=[Place("filter", str(problem))]) from None
    if not isinstance(fields, dict):
        raise BadField("The filter must be a JSON object.", places=[Place("filter", str(text))])
    return fields


def _print_hits(hits: Hits, as_json: bool, *, by_words: bool, with_times: bool) -> None:
    """Print hits; with_times: with the start and the end of the part that was found."""
    if as_json:
        from app.api.schemas.search import MotionHits, WordHits

        answer = (WordHits if by_words else MotionHits).model_validate(hits)
        print_json(answer.model_dump(mode="json"))
        return
    print_table(
        (
            "rank",
            "score",
            *(("start", "end") if with_times else ()),
            "name",
            "person",
            "task",
            "id",
        ),
        [
            (
                hit.rank,
                hit.score,
                *((hit.start, hit.end) if with_times else ()),
                hit.clip.full_name,
                hit.clip.person,
                hit.clip.task,
                hit.clip.id,
            )
            for hit in hits.items
        ],
    )
    if hits.unknown_words:
        typer.echo(f"No clip has the words: {', '.join(hits.unknown_words)}", err=True)
