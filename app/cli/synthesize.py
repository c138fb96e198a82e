"""The command that synthesizes a motion of a person that was never recorded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.files import write_whole
from app.cli.output import AsJson, print_json, print_table
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.synthesis import Quality, Synthesis

LEFT_OUT = {"motion", "bvh"}
"""Members of the answer that the JSON leaves out: the file contains the motion."""


def synthesize(
    context: typer.Context,
    task: Annotated[str, typer.Argument(help="The task of the motion.")],
    person: Annotated[str | None, typer.Option(help="A person in the library.")] = None,
    clip: Annotated[
        list[str] | None,
        typer.Option(help="The id of a clip of the person; may be repeated."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="BVH file to write; default: named after person and task, in this folder.",
        ),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="Duration; default: the usual duration of the task.")
    ] = None,
    store: Annotated[bool, typer.Option("--store", help="Store the motion as a clip.")] = False,
    as_json: AsJson = False,
) -> None:
    """Synthesize a motion that a person never recorded, as a BVH file, and report its quality."""
    if (person is None) == (not clip):
        raise typer.BadParameter("give either --person or --clip, not both")
    with open_client(context) as client:
        made = client.synthesize(
            task, person=person, clip_ids=clip or None, seconds=seconds, store=store, bvh=True
        )
    content = (made.bvh or "").encode()
    title = f"{made.clip.person or 'someone'} {made.clip.name}"
    path = output or Path(f"{_file_name(title)}.bvh")
    write_whole(path, [content])
    if as_json:
        result = {name: one for name, one in made.to_json().items() if name not in LEFT_OUT}
        print_json({"path": str(path), "bytes": len(content)} | result)
    else:
        print_table(("", ""), _quality_rows(made, path, len(content)))


def _quality_rows(made: Synthesis, path: Path, size: int) -> list[tuple[str, object]]:
    quality = made.quality
    rows: list[tuple[str, object]] = [
        ("file", f"{path}: {size} bytes, {made.clip.duration or 0:.2f} s"),
        ("made from", _donors(quality)),
        ("nearest real clip", quality.nearest_clip.name if quality.nearest_clip else "deleted"),
        ("its labels", f"{quality.nearest_person}, {quality.nearest_task}"),
        ("expected accuracy", _expected_accuracy(quality)),
        ("speed of sliding feet", f"{quality.skate:.2f} m/s{_real_skate(quality.real_skate)}"),
        ("jerk", f"{quality.jerk:.0f} m/s³{_real_jerk(quality.real_jerk)}"),
        *(("warning", warning.detail) for warning in quality.warnings),
    ]
    if made.clip.id is not None:
        rows.append(("stored as", made.clip.id))
    return rows


def _donors(quality: Quality) -> str:
    """The takes from which the motion was made."""
    if quality.kind == "seen":
        takes = (
            "one of the person's own takes, because they differ too much"
            if quality.follows
            else "the person's own takes"
        )
        return f"{takes}: the person did record this task"
    tasks, persons = len(quality.given_tasks), len(quality.given_persons)
    if quality.follows:
        return f"{tasks} tasks of the person, and {quality.follows}: takes of this task differ"
    return f"{tasks} tasks of the person, and takes of this task by {persons} other persons"


def _expected_accuracy(quality: Quality) -> str:
    """How often synthesized motions like this one were recognized with the right labels."""
    if quality.expected_hit is None:
        return "not measured"
    return (
        f"{quality.expected_hit:.0%} (learned from {quality.expected_trials} held-out motions)"
        f"{_real_accuracy(quality.real_hit)}"
    )


def _real_accuracy(share: float | None) -> str:
    return "" if share is None else f"; of real takes {share:.0%}"


def _real_skate(speed: float | None) -> str:
    return "" if speed is None else f", in real takes {speed:.2f} m/s"


def _real_jerk(jerk: float | None) -> str:
    return "" if jerk is None else f", in real takes {jerk:.0f} m/s³"


def _file_name(name: str) -> str:
    """`name` as a valid file name on every system: other characters become "_"."""
    return "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in name).strip(" .")[:100]
