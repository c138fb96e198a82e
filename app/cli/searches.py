"""The commands for saved searches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import FilterJson, filter_of
from app.cli.output import AsCsv, AsJson, clip_title, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.composed_search import ComposedHit

program = typer.Typer(help="Save searches, run them again, and see new hits.", no_args_is_help=True)

DEFAULT_LIMIT = 10
"""Hits of a query that does not say how many."""
SearchId = Annotated[str, typer.Argument(help="The id of a saved search.")]


@program.command("list")
def list_searches(context: typer.Context, as_json: AsJson = False, as_csv: AsCsv = False) -> None:
    """List the saved searches, the newest first."""
    with open_client(context) as client:
        found = list(client.searches.list())
    if as_json:
        print_json({"items": [one.to_json() for one in found]})
    elif as_csv:
        columns = ("id", "name", "seen_at", "created_at")
        print_csv(columns, [one.to_json() for one in found])
    else:
        rows = [(one.id, one.name, f"{one.seen_at:%Y-%m-%d %H:%M}") for one in found]
        print_table(("id", "name", "seen"), rows, cut=("name",))


@program.command("save")
def save(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="The name of the search.")],
    like: Annotated[
        list[str] | None, typer.Option(help="The id of a clip as an example; may be repeated.")
    ] = None,
    words: Annotated[
        str | None, typer.Option(help="Words; -word leaves out clips that carry it.")
    ] = None,
    limit: Annotated[int, typer.Option(help="Hits that are followed.", min=1, max=1000)] = 10,
    filter_json: FilterJson = None,
    as_json: AsJson = False,
) -> None:
    """Save a search by examples and words."""
    query: Any = {"limit": limit}
    if like:
        query["examples"] = [{"clip_id": clip_id} for clip_id in like]
    if words:
        query["words"] = words.split()
    if filter_json is not None:
        query["filter"] = filter_of(filter_json)
    with open_client(context) as client:
        saved = client.searches.save(name, query)
    if as_json:
        print_json(saved.to_json())
    else:
        typer.echo(f"{saved.id}: {saved.name}")


@program.command("run")
def run(
    context: typer.Context, search_id: SearchId, as_json: AsJson = False, as_csv: AsCsv = False
) -> None:
    """Run a saved search again."""
    with open_client(context) as client:
        limit = client.searches.get(search_id).query.get("limit", DEFAULT_LIMIT)
        hits = list(client.searches.hits(search_id, limit=limit))
    _print_hits(hits, as_json=as_json, as_csv=as_csv)


@program.command("new")
def new(
    context: typer.Context,
    search_id: SearchId,
    seen: Annotated[
        bool, typer.Option("--seen", help="Then count the present hits as seen.")
    ] = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Show the hits that came since the search was last looked at."""
    with open_client(context) as client:
        found = client.searches.new_hits(search_id)
        if seen:
            client.searches.mark_seen(search_id)
    _print_hits(found.items, as_json=as_json, as_csv=as_csv)


@program.command("rename")
def rename(
    context: typer.Context,
    search_id: SearchId,
    name: Annotated[str, typer.Argument(help="The new name.")],
) -> None:
    """Give a saved search another name."""
    with open_client(context) as client:
        client.searches.update(search_id, name=name)


@program.command("delete")
def delete(context: typer.Context, search_id: SearchId) -> None:
    """Delete a saved search."""
    with open_client(context) as client:
        client.searches.delete(search_id)
    typer.echo(f"{search_id} is deleted.")


def _print_hits(hits: Sequence[ComposedHit], *, as_json: bool, as_csv: bool) -> None:
    if as_json:
        print_json({"items": [hit.to_json() for hit in hits]})
        return
    columns = ("rank", "score", "clip", "name", "person", "task")
    rows: list[dict[str, Any]] = [
        {
            "rank": hit.rank,
            "score": round(hit.score, 4),
            "clip": hit.clip.id,
            "name": clip_title(hit.clip.name, hit.clip.path),
            "person": hit.clip.person,
            "task": hit.clip.task,
        }
        for hit in hits
    ]
    if as_csv:
        print_csv(columns, rows)
    else:
        print_table(columns, [tuple(row.values()) for row in rows], cut=("name",))
