"""The command that lists groups of near-duplicates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.curation import DuplicateGroup

COLUMNS = (
    *("group", "keeper", "clip_id", "other_id", "kind", "distance", "offset", "shift"),
    *("seconds", "is_mirrored"),
)


def duplicates(
    context: typer.Context,
    threshold: Annotated[
        float, typer.Option(help="Largest distance of two takes that count as almost the same.")
    ] = 0.0,
    kind: Annotated[
        str | None, typer.Option(help="exact, copy, rate, format, cut, mirror or similar.")
    ] = None,
    limit: Annotated[int, typer.Option(help="Largest number of groups; 0 for all.", min=0)] = 20,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """List groups of near-duplicates, each with the clip to keep."""
    asked: Any = {"threshold": threshold, "kind": kind, "limit": limit or None}
    with open_client(context) as client:
        groups = list(client.curation.duplicates(**asked))
    if as_json:
        print_json({"items": [group.to_json() for group in groups]})
    elif as_csv:
        print_csv(COLUMNS, (row for group in groups for row in _rows(group)))
    else:
        for group in groups:
            _print_group(group)
        if not groups:
            typer.echo("No near-duplicates. A worker compares new clips when it is idle.")


def _rows(group: DuplicateGroup) -> list[dict[str, Any]]:
    return [{"group": group.id, "keeper": group.keeper, **pair.to_json()} for pair in group.pairs]


def _print_group(group: DuplicateGroup) -> None:
    kinds: dict[str, set[str]] = {}
    for pair in group.pairs:
        for clip_id in (pair.clip_id, pair.other_id):
            kinds.setdefault(clip_id, set()).add(pair.kind)
    typer.echo(group.id)
    rows = [
        (
            "keep" if clip.id == group.keeper else "",
            clip.id,
            clip.name,
            ", ".join(sorted(kinds.get(clip.id, ()))),
            clip.duration,
            clip.frame_rate,
            clip.joints,
        )
        for clip in group.clips
    ]
    print_table(("", "id", "name", "pairs", "seconds", "Hz", "joints"), rows, cut=("name",))
