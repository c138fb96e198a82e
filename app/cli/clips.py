"""The commands for stored clips: list, show, label, delete."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import FilterJson, filter_of, metadata_of
from app.cli.output import AsCsv, AsJson, clip_title, print_csv, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.clips import Clip
    from kinedex.types.measures import MeasuredClip

program = typer.Typer(help="List, show, label and delete stored clips.", no_args_is_help=True)

COLUMNS = (
    "id",
    "name",
    "path",
    "state",
    "format",
    "person",
    "task",
    "words",
    "captions",
    "license",
    "source",
    "frames",
    "frame_rate",
    "duration",
    "joints",
    "created_at",
    "sha256",
)
"""The columns of a list of clips as CSV; a column follows for each key of the metadata."""
METADATA = "metadata."
"""The beginning of the columns of metadata in flat rows."""
ClipIds = Annotated[list[str], typer.Argument(help="Ids of clips.", metavar="CLIP_ID...")]


@program.command("list")
def list_clips(
    context: typer.Context,
    person: Annotated[list[str] | None, typer.Option(help="May be repeated.")] = None,
    task: Annotated[list[str] | None, typer.Option(help="May be repeated.")] = None,
    word: Annotated[list[str] | None, typer.Option(help="May be repeated.")] = None,
    folder: Annotated[
        list[str] | None, typer.Option(help="Folder of the import, and those below it.")
    ] = None,
    meta: Annotated[
        list[str] | None,
        typer.Option(
            help="Metadata as KEY=VALUE; KEY.min=30 and KEY.max=40 for numbers; may be repeated."
        ),
    ] = None,
    state: Annotated[str | None, typer.Option(help="queued, processing, ready or failed.")] = None,
    q: Annotated[
        str | None, typer.Option("-q", "--name", help="Part of the name, path or metadata.")
    ] = None,
    sort: Annotated[
        str,
        typer.Option(help="created_at, name, duration, person or task; -name for the reverse."),
    ] = "-created_at",
    limit: Annotated[int, typer.Option(help="Largest number of clips; 0 for all.", min=0)] = 50,
    filter_json: FilterJson = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """List clips, the newest first."""
    labels = {"person": person, "task": task, "word": word, "folder": folder}
    given = {name: values for name, values in labels.items() if values}
    filters = filter_of(filter_json) | given | _conditions(meta or [])
    others: dict[str, Any] = {"state": state, "q": q, "sort": sort, "limit": limit or None}
    with open_client(context) as client:
        clips = list(client.clips.list(filter=filters, **others))
    if as_json:
        print_json({"items": [clip.to_json() for clip in clips]})
    elif as_csv:
        _print_csv(clips)
    else:
        columns = ("id", "name", "person", "task", "state", "duration")
        rows = [
            (c.id, clip_title(c.name, c.path), c.person, c.task, c.state, c.duration) for c in clips
        ]
        print_table(columns, rows, cut=("name", "person", "task"))


@program.command("show")
def show(
    context: typer.Context,
    clip_id: Annotated[str, typer.Argument(help="The id of a clip.")],
    as_json: AsJson = False,
) -> None:
    """Show one clip, with its warnings and the reason if it failed."""
    with open_client(context) as client:
        clip = client.clips.get(clip_id)
    _print_clips([clip], as_json, is_one=True)


@program.command("label")
def label(
    context: typer.Context,
    clip_ids: ClipIds,
    name: Annotated[str | None, typer.Option(help="A new name.")] = None,
    person: Annotated[str | None, typer.Option(help='The person; "" removes it.')] = None,
    task: Annotated[str | None, typer.Option(help='The task; "" removes it.')] = None,
    words: Annotated[
        str | None, typer.Option(help='All words, separated by spaces; "" removes them.')
    ] = None,
    caption: Annotated[
        list[str] | None,
        typer.Option(help='A sentence that describes it; may be repeated; "" removes all.'),
    ] = None,
    license: Annotated[str | None, typer.Option(help='The license; "" removes it.')] = None,
    source: Annotated[str | None, typer.Option(help='The source; "" removes it.')] = None,
    meta: Annotated[
        list[str] | None,
        typer.Option(help="Metadata as KEY=VALUE; KEY= removes the key; may be repeated."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Correct the labels of clips. Labels that are not given stay as they are."""
    labels = _given_labels(
        name=name, person=person, task=task, words=words, license=license, source=source
    )
    if meta:
        labels["metadata"] = metadata_of(meta)
    if caption is not None:
        labels["captions"] = [text for text in caption if text.strip()]
    if not labels:
        raise typer.BadParameter("give at least one label, for example --task walk")
    with open_client(context) as client:
        clips = [client.clips.update(clip_id, **labels) for clip_id in clip_ids]
    _print_clips(clips, as_json, is_one=len(clip_ids) == 1)


@program.command("delete")
def delete(
    context: typer.Context,
    clip_ids: ClipIds,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
) -> None:
    """Delete clips, their files and everything that was computed from them."""
    if not yes:
        noun = "clip" if len(clip_ids) == 1 else "clips"
        typer.confirm(f"Delete {len(clip_ids)} {noun}?", abort=True, err=True)
    with open_client(context) as client:
        for clip_id in clip_ids:
            client.clips.delete(clip_id)
            typer.echo(f"{clip_id} is deleted.")


def _given_labels(**labels: str | None) -> dict[str, Any]:
    """The labels to change, by name; an empty text removes a label.

    `words` becomes a list: they are separated by spaces.
    """
    given: dict[str, Any] = {name: text for name, text in labels.items() if text is not None}
    changed = {name: text or None for name, text in given.items()}
    if "words" in given:
        changed["words"] = given["words"].split()
    return changed


def _conditions(pairs: Sequence[str]) -> dict[str, list[str]]:
    """The conditions of a filter in texts like KEY=VALUE. A repeated key accepts several values."""
    conditions: dict[str, list[str]] = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or not key.strip():
            raise typer.BadParameter(f"{pair!r}: write KEY=VALUE", param_hint="--meta")
        conditions.setdefault(f"meta.{key.strip()}", []).append(value.strip())
    return conditions


def _print_csv(clips: Sequence[Clip]) -> None:
    from kinedex.tables import flat

    rows = [flat(clip.to_json()) for clip in clips]
    keys = {name for row in rows for name in row if name.startswith(METADATA)}
    print_csv((*COLUMNS, *sorted(keys)), rows)


def _print_clips(clips: Sequence[Clip | MeasuredClip], as_json: bool, *, is_one: bool) -> None:
    if as_json:
        documents = [clip.to_json() for clip in clips]
        print_json(documents[0] if is_one else {"items": documents})
        return
    for clip in clips:
        print_table(("", ""), _details(clip))


def _details(clip: Clip | MeasuredClip) -> list[tuple[str, object]]:
    rows: list[tuple[str, object]] = [
        (name, getattr(clip, name)) for name in ("id", "name", "state", "person", "task")
    ]
    rows += [
        ("words", " ".join(clip.words) or None),
        *(("caption", text) for text in clip.captions),
        ("license", clip.license),
        ("source", clip.source),
        *((f"meta {key}", value) for key, value in clip.metadata.items()),
        ("path", clip.path),
        ("format", clip.format),
        ("duration", None if clip.duration is None else f"{clip.duration:.2f} s"),
        ("frames", None if clip.frames is None else f"{clip.frames} at {clip.frame_rate:g} Hz"),
        ("joints", clip.joints),
        ("created", f"{clip.created_at:%Y-%m-%d %H:%M:%S} UTC"),
    ]
    if clip.start_offset:
        rows.append(("begins", f"{clip.start_offset:.3f} s after the start of the file"))
    rows += [("reanalysis", clip.reanalysis)] if clip.reanalysis else []
    if clip.origin is not None:
        state = " (deleted)" if clip.origin.deleted else ""
        steps = ", ".join(str(step["kind"]) for step in clip.origin.steps)
        rows.append(("made from", f"{clip.origin.clip_id}{state}: {steps}"))
    rows += [(f"warning {one.code}", one.detail) for one in clip.warnings]
    if clip.error is not None:
        rows.append(("error", clip.error.detail))
        rows += [(place.location, place.message) for place in clip.error.errors]
    return rows
