"""The commands for annotations of clips: list, export, import, suggest, accept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.files import write_whole
from app.cli.options import FilterJson, filter_of
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.annotations import Annotation

program = typer.Typer(
    help="Words and persons for parts of clips, with start and end.", no_args_is_help=True
)

COLUMNS = ("id", "clip_id", "start", "end", "words", "person", "text", "by", "origin")
SUGGESTED = ("start", "end", "words", "probability", "person", "person_probability")
ENDINGS = {".csv": "csv", ".eaf": "eaf", ".json": "babel"}
"""The format of a file by the ending of its name."""
ClipId = Annotated[str, typer.Argument(help="The id of a clip.", metavar="CLIP_ID")]
Format = Annotated[
    str | None, typer.Option("--format", help="csv, eaf or babel; default: by the name's ending.")
]


@program.command("list")
def list_annotations(
    context: typer.Context, clip_id: ClipId, as_json: AsJson = False, as_csv: AsCsv = False
) -> None:
    """List the annotations of a clip, by start."""
    with open_client(context) as client:
        found = client.clips.list_annotations(clip_id)
    _print(found.items, as_json, as_csv)


@program.command("export")
def export(
    context: typer.Context,
    output: Annotated[Path, typer.Option("-o", "--output", help="The file to write.")],
    clip_id: Annotated[
        str | None, typer.Argument(help="The id of a clip; without it, all clips as CSV.")
    ] = None,
    format: Format = None,
    filter_json: FilterJson = None,
) -> None:
    """Write the annotations of a clip, or of the library, to a file (CSV, ELAN or BABEL)."""
    chosen: Any = format or ENDINGS.get(output.suffix.lower(), "csv")
    if clip_id is None and chosen != "csv":
        raise typer.BadParameter("a file of many clips is CSV; name a clip", param_hint="CLIP_ID")
    with open_client(context) as client:
        if clip_id is None:
            content = client.labels.annotation_table(filter=filter_of(filter_json) or None)
        else:
            content = client.clips.annotation_file(clip_id, format=chosen)
    write_whole(output, [content])
    typer.echo(f"{output} is written.")


@program.command("import")
def import_file(
    context: typer.Context,
    clip_id: ClipId,
    file: Annotated[Path, typer.Argument(help="CSV, ELAN (.eaf) or BABEL (.json).")],
    format: Format = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Replace the annotations of a clip by those of a file."""
    chosen: Any = format or ENDINGS.get(file.suffix.lower())
    if chosen is None:
        raise typer.BadParameter("the name does not say the format", param_hint="--format")
    with open_client(context) as client:
        stored = client.clips.put_annotation_file(clip_id, file, format=chosen)
    _print(stored.items, as_json, as_csv)


@program.command("suggest")
def suggest(
    context: typer.Context, clip_id: ClipId, as_json: AsJson = False, as_csv: AsCsv = False
) -> None:
    """Show parts of a clip without annotation, with the words that the models see there."""
    with open_client(context) as client:
        found = client.clips.suggest_annotations(clip_id)
    rows = [one.to_json() for one in found.items]
    if as_json:
        print_json({"items": rows})
    elif as_csv:
        print_csv(SUGGESTED, rows)
    else:
        shown = ("start", "end", "words", "probability", "person")
        print_table(shown, [[_cell(row[name]) for name in shown] for row in rows], cut=("words",))


@program.command("accept")
def accept(
    context: typer.Context,
    clip_id: ClipId,
    by: Annotated[str | None, typer.Option(help="Who accepts.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Make annotations of all suggestions for a clip."""
    with open_client(context) as client:
        stored = client.clips.accept_annotations(clip_id, by=by)
    _print(stored.items, as_json, as_csv)


def _print(found: Sequence[Annotation], as_json: bool, as_csv: bool) -> None:
    rows = [one.to_json() for one in found]
    if as_json:
        print_json({"items": rows})
    elif as_csv:
        print_csv(COLUMNS, rows)
    else:
        shown = ("start", "end", "words", "person", "by", "origin", "id")
        print_table(shown, [[_cell(row[name]) for name in shown] for row in rows], cut=("words",))


def _cell(value: Any) -> Any:
    return " ".join(value) if isinstance(value, list) else value
