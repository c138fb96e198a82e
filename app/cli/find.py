"""The commands that search by example or by words, and that recognize a motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.hits import print_hits
from app.cli.options import FilterJson, IncludeSelf, filter_of
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table, print_text
from app.cli.query_source import (
    FrameRate,
    Query,
    Skeleton,
    Stack,
    Unit,
    UpAxis,
    naming_missing,
    query_of,
)
from app.cli.session import open_client
from app.search.example.methods import Method

if TYPE_CHECKING:
    from kinedex.types.recognition import Answer, Recognition
    from kinedex.types.search import WordHits

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
    tempo: Annotated[
        str,
        typer.Option(
            help="Method fused: any (also faster, slower, cut or repeated) or same (as it is)."
        ),
    ] = "any",
    max_distance: Annotated[
        float | None,
        typer.Option(min=0.0, help="Only hits at most this far, in the unit of the method."),
    ] = None,
    q: Annotated[
        int,
        typer.Option("--q", min=1, max=2, help="Methods msv-*: norm of distances, 1 or 2."),
    ] = 2,
    eta: Annotated[
        float,
        typer.Option(min=0.0, help="Methods msv-*: threshold in body lengths; 0 for none."),
    ] = 0.0,
    normalized: Annotated[
        bool,
        typer.Option("--normalized", help="Method msv-xcorr: without the ratio of the lengths."),
    ] = False,
    mode: Annotated[
        str, typer.Option(help="Mode of a search by words: default, cca or printed.")
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
    as_csv: AsCsv = False,
) -> None:
    """Find motions that are similar to a file or a stored clip, or motions for words."""
    if (query is None) == (not words):
        raise typer.BadParameter("give either a file or clip id, or --words")
    fields: Any = filter_of(filter_json) or None
    by_words: Any = {"mode": mode, "scope": scope, "limit": limit, "filter": fields}
    by_example: dict[str, Any] = {
        "method": method.value,
        "scope": scope,
        "segment": segment,
        "tempo": tempo,
        "max_distance": max_distance,
        "q": q,
        "eta": eta,
        "normalized": normalized,
        "limit": limit,
        "filter": fields,
        "include_self": include_self,
        "start": start,
        "end": end,
        "frame_rate": frame_rate,
        "unit": unit,
        "up_axis": up_axis,
        "stack": stack,
    }
    times = ("start", "end") if scope != "clips" else ()
    with open_client(context) as client:
        if query is None:
            found = client.search.words(words or [], **by_words)
            _print_words(found, times, as_json, as_csv)
            return
        with naming_missing(query, ADVICE):
            arguments = query_of(query, skeleton=skeleton, **by_example)
            hits = client.search.motion(**arguments)
    print_hits(hits, times, as_json=as_json, as_csv=as_csv)


def recognize(
    context: typer.Context,
    query: Query,
    known_person: Annotated[str | None, typer.Option(help="The person, if known.")] = None,
    known_task: Annotated[str | None, typer.Option(help="The task, if known.")] = None,
    method: Annotated[
        str, typer.Option(help="default, multilinear, signatures or perera.")
    ] = "default",
    word_mode: Annotated[
        str, typer.Option(help="How words are predicted: default, cca or printed.")
    ] = "default",
    skeleton: Skeleton = None,
    frame_rate: FrameRate = None,
    unit: Unit = None,
    up_axis: UpAxis = None,
    stack: Stack = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Recognize the person and the task of a motion, and describe it with words."""
    hints: Any = {
        "known_person": known_person,
        "known_task": known_task,
        "method": method,
        "word_mode": word_mode,
        "frame_rate": frame_rate,
        "unit": unit,
        "up_axis": up_axis,
        "stack": stack,
    }
    with open_client(context) as client, naming_missing(query):
        answer = client.recognize(**query_of(query, skeleton=skeleton, **hints))
    if as_json:
        print_json(answer.to_json())
    elif as_csv:
        print_csv(("kind", "label", "score", "known"), _answer_rows(answer))
    else:
        rows = [
            (name, _answer_text(one), one.score)
            for name, one in (("person", answer.person), ("task", answer.task))
        ]
        print_table(("", "answer", "score"), rows)
        print_table(("word", "score"), [(one.word, one.score) for one in answer.words])
        for warning in answer.warnings:
            print_text(warning)


def _answer_rows(answer: Recognition) -> list[dict[str, Any]]:
    """A row for each possible person, task and word. known: whether it is the answer."""
    rows = [
        {"kind": kind, "label": c.label, "score": c.score, "known": c.label == one.label}
        for kind, one in (("person", answer.person), ("task", answer.task))
        for c in one.candidates
    ]
    return rows + [{"kind": "word", "label": w.word, "score": w.score} for w in answer.words]


def _answer_text(answer: Answer) -> str:
    """The label, or "unknown" with the nearest label."""
    if answer.known and answer.label is not None:
        return answer.label
    nearest = answer.candidates[0].label if answer.candidates else "nothing"
    return f"unknown (nearest: {nearest})"


def _print_words(hits: WordHits, times: Sequence[str], as_json: bool, as_csv: bool) -> None:
    print_hits(hits, times, as_json=as_json, as_csv=as_csv)
    if as_json:
        return
    for word, used in hits.expanded.items():
        sure = hits.confidence[word]
        if sure < 1.0:
            typer.echo(f"{word}: searched as {', '.join(used)} ({sure:.2f} sure)", err=True)
    if hits.unknown_words:
        typer.echo(f"No clip has the words: {', '.join(hits.unknown_words)}", err=True)
