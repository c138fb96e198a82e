"""The commands for collections: named sets of clips or parts of clips."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.files import write_whole
from app.cli.options import FilterJson, filter_of
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client
from app.services.views.export_format import ExportFormat, ExportSkeleton

if TYPE_CHECKING:
    from kinedex.types.bodies import CollectionItemForm
    from kinedex.types.collection_statistics import CollectionStatistics, CoverageCell
    from kinedex.types.collections import Collection

program = typer.Typer(help="Make, fill, show and export collections.", no_args_is_help=True)

CollectionId = Annotated[str, typer.Argument(help="The id of a collection.")]
Items = Annotated[
    list[str] | None,
    typer.Argument(metavar="[CLIP_ID]...", help="Clips; a part is CLIP_ID:START:END, in seconds."),
]
Like = Annotated[list[str] | None, typer.Option(help="Add hits like this clip; may be repeated.")]
Words = Annotated[str | None, typer.Option(help="Add hits of a search for these words.")]
LimitOfHits = Annotated[int, typer.Option("--limit", help="Hits to add.", min=1, max=1000)]
COLUMNS = ("id", "name", "size", "notes", "created_at", "changed_at")


@program.command("list")
def list_collections(
    context: typer.Context, as_json: AsJson = False, as_csv: AsCsv = False
) -> None:
    """List the collections, the newest first."""
    with open_client(context) as client:
        found = list(client.collections.list())
    documents = [one.to_json() for one in found]
    if as_json:
        print_json({"items": documents})
    elif as_csv:
        print_csv(COLUMNS, documents)
    else:
        print_table(("id", "name", "size"), [(c.id, c.name, c.size) for c in found], cut=("name",))


@program.command("create")
def create(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="The name of the collection.")],
    items: Items = None,
    notes: Annotated[str, typer.Option(help="Notes.")] = "",
    filter_json: FilterJson = None,
    like: Like = None,
    words: Words = None,
    limit: LimitOfHits = 50,
    as_json: AsJson = False,
) -> None:
    """Make a collection of clips, parts, the clips of a filter, or the hits of a search."""
    given = _given(items, filter_json, like, words, limit)
    with open_client(context) as client:
        _print(client.collections.create(name, notes=notes, **given), as_json)


@program.command("add")
def add(
    context: typer.Context,
    collection_id: CollectionId,
    items: Items = None,
    filter_json: FilterJson = None,
    like: Like = None,
    words: Words = None,
    limit: LimitOfHits = 50,
    as_json: AsJson = False,
) -> None:
    """Add clips, parts, the clips of a filter, or the hits of a search."""
    given = _given(items, filter_json, like, words, limit)
    if not given:
        raise typer.BadParameter("give clips, --filter, --like or --words")
    with open_client(context) as client:
        _print(client.collections.add(collection_id, **given), as_json)


@program.command("show")
def show(
    context: typer.Context,
    collection_id: CollectionId,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Show a collection and its items, in their order."""
    with open_client(context) as client:
        collection = client.collections.get(collection_id)
        items = list(client.collections.items(collection_id))
    rows: list[dict[str, Any]] = [
        {"item": i.id, "clip": i.clip.id, "name": i.clip.name, "start": i.start, "end": i.end}
        | {"task": i.clip.task, "notes": i.notes or None}
        for i in items
    ]
    if as_json:
        print_json(collection.to_json() | {"items": [item.to_json() for item in items]})
    elif as_csv:
        print_csv(("item", "clip", "name", "start", "end", "task", "notes"), rows)
    else:
        typer.echo(f"{collection.name} ({collection.size} items) {collection.notes}".strip())
        columns = ("item", "clip", "name", "start", "end")
        print_table(columns, [tuple(row[c] for c in columns) for row in rows], cut=("name",))


@program.command("remove")
def remove(
    context: typer.Context,
    collection_id: CollectionId,
    item_ids: Annotated[list[str], typer.Argument(help="Ids of items.", metavar="ITEM_ID...")],
) -> None:
    """Take items out of a collection. Their clips stay."""
    with open_client(context) as client:
        for item_id in item_ids:
            client.collections.remove_item(collection_id, item_id)
            typer.echo(f"{item_id} is removed.")


@program.command("order")
def order(
    context: typer.Context,
    collection_id: CollectionId,
    item_ids: Annotated[list[str], typer.Argument(help="Ids of items.", metavar="ITEM_ID...")],
) -> None:
    """Put items first, in this order."""
    with open_client(context) as client:
        client.collections.order(collection_id, item_ids)


@program.command("change")
def change(
    context: typer.Context,
    collection_id: CollectionId,
    name: Annotated[str | None, typer.Option(help="A new name.")] = None,
    notes: Annotated[str | None, typer.Option(help="New notes.")] = None,
    as_json: AsJson = False,
) -> None:
    """Change the name or the notes of a collection."""
    sent = {key: text for key, text in (("name", name), ("notes", notes)) if text is not None}
    if not sent:
        raise typer.BadParameter("give --name or --notes")
    with open_client(context) as client:
        _print(client.collections.update(collection_id, **sent), as_json)


@program.command("delete")
def delete(
    context: typer.Context,
    collection_id: CollectionId,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
) -> None:
    """Delete a collection. Its clips stay."""
    if not yes:
        typer.confirm(f"Delete {collection_id}?", abort=True, err=True)
    with open_client(context) as client:
        client.collections.delete(collection_id)
    typer.echo(f"{collection_id} is deleted.")


@program.command("export")
def export(
    context: typer.Context,
    collection_id: CollectionId,
    output: Annotated[Path, typer.Option("--output", "-o", help="The ZIP to write.")] = Path(
        "collection.zip"
    ),
    format: Annotated[ExportFormat, typer.Option(help="Of the files.")] = ExportFormat.BVH,
    skeleton: Annotated[
        ExportSkeleton, typer.Option(help="Each clip's own joints, or one body for all clips.")
    ] = ExportSkeleton.OWN,
    fps: Annotated[float | None, typer.Option(help="Default: each clip's own rate.")] = None,
) -> None:
    """Export a collection as a ZIP, with a manifest, licenses and credits."""
    with open_client(context) as client:
        content = client.collections.export(
            collection_id, format.value, skeleton=skeleton.value, fps=fps
        )
    typer.echo(f"{output}: {write_whole(output, [content])} bytes")


@program.command("statistics")
def statistics(
    context: typer.Context, collection_id: CollectionId, as_json: AsJson = False
) -> None:
    """Show what a collection covers beside the library, and what would fill it."""
    with open_client(context) as client:
        found = client.collections.statistics(collection_id)
    if as_json:
        print_json(found.to_json())
        return
    print_table(("", ""), _summary(found))
    print_table(
        ("speed m/s", "turn deg/s", "seconds", "in library"),
        [(_speeds(c), _turns(c), c.seconds, c.library_seconds) for c in found.cells],
    )
    for one in found.proposals:
        typer.echo(f"{one.action} {one.clip.id} {one.clip.name}: {one.seconds:.1f} s")


def _given(
    items: Sequence[str] | None,
    filter_json: str | None,
    like: Sequence[str] | None,
    words: str | None,
    limit: int,
) -> dict[str, Any]:
    """What is added, as the API takes it."""
    given: dict[str, Any] = {}
    if items:
        given["items"] = [_item(text) for text in items]
    if filter_json is not None:
        given["filter"] = filter_of(filter_json)
    if like or words:
        examples = [{"clip_id": clip_id} for clip_id in like or ()]
        search = {"examples": examples, "words": (words or "").split(), "limit": limit}
        given["search"] = {name: value for name, value in search.items() if value}
    return given


def _item(text: str) -> CollectionItemForm:
    """A clip, or a part of one as CLIP_ID:START:END. Raises BadParameter."""
    clip_id, *times = text.split(":")
    try:
        numbers = [float(time) if time else None for time in times]
    except ValueError:
        numbers = [None] * 3
    if len(numbers) > 2:
        raise typer.BadParameter(f"{text!r}: write CLIP_ID or CLIP_ID:START:END")
    item: Any = {"clip_id": clip_id}
    item |= {
        name: number
        for name, number in zip(("start", "end"), numbers, strict=False)
        if number is not None
    }
    made: CollectionItemForm = item
    return made


def _print(collection: Collection, as_json: bool) -> None:
    if as_json:
        print_json(collection.to_json())
    else:
        typer.echo(f"{collection.id}: {collection.name} ({collection.size} items)")


def _summary(found: CollectionStatistics) -> list[tuple[str, object]]:
    share = "no poses" if found.pose_share is None else f"{found.pose_share:.0%}"
    return [
        ("items", f"{found.items} of {found.clips} clips, {found.seconds:.1f} s"),
        ("compared", f"{found.library_clips} of {found.library_size} clips of the library"),
        ("covered cells", f"{found.covered_cells} (library: {found.library_cells})"),
        ("covered poses", share),
        *((d.direction, f"{d.seconds:.1f} s") for d in found.directions),
    ]


def _speeds(cell: CoverageCell) -> str:
    return f"{cell.min_speed:g} to {'...' if cell.max_speed is None else f'{cell.max_speed:g}'}"


def _turns(cell: CoverageCell) -> str:
    low = "..." if cell.min_turn is None else f"{cell.min_turn:g}"
    return f"{low} to {'...' if cell.max_turn is None else f'{cell.max_turn:g}'}"
