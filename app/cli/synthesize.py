"""The command that synthesizes a motion of a person that was never recorded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.files import write_whole
from app.cli.output import AsJson, print_json, print_table
from app.cli.settings import open_library

if TYPE_CHECKING:
    from app.services.synthesis.synthesize import Synthesized


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
    from app.services.synthesis.synthesize import SynthesisQuery, synthesize

    if (person is None) == (not clip):
        raise typer.BadParameter("give either --person or --clip, not both")
    query = SynthesisQuery(
        task=task,
        person=person,
        clip_ids=tuple(clip) if clip else None,
        seconds=seconds,
        store=store,
    )
    with open_library(context) as lib:
        synthesized = synthesize(lib, query)
    person_name = synthesized.person or "someone"
    path = output or Path(f"{_file_name(f'{person_name} {synthesized.name}')}.bvh")
    write_whole(path, [synthesized.bvh])
    if as_json:
        from app.api.schemas.synthesis import Synthesis

        document = Synthesis.of(synthesized, with_bvh=False)
        result = document.model_dump(mode="json", exclude={"motion"})
        print_json({"path": str(path), "bytes": len(synthesized.bvh)} | result)
        return
    _print_quality(synthesized, path)


def _print_quality(synthesized: Synthesized, path: Path) -> None:
    quality, duration = synthesized.quality, synthesized.motion.duration
    rows: list[tuple[str, object]] = [
        ("file", f"{path}: {len(synthesized.bvh)} bytes, {duration:.2f} s"),
        ("made from", _donors(synthesized)),
        ("nearest real clip", quality.nearest.full_name if quality.nearest else "deleted"),
        ("its labels", f"{quality.nearest_person}, {quality.nearest_task}"),
        ("expected accuracy", _expected_accuracy(synthesized)),
        ("speed of sliding feet", f"{quality.skate:.2f} m/s{_real_skate(quality.real_skate)}"),
    ]
    if synthesized.clip is not None:
        rows.append(("stored as", synthesized.clip.id))
    print_table(("", ""), rows)


def _donors(synthesized: Synthesized) -> str:
    """The takes from which the motion was made."""
    from app.services.synthesis.plan import SynthesisKind

    quality = synthesized.quality
    if quality.kind is SynthesisKind.SEEN:
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


def _expected_accuracy(synthesized: Synthesized) -> str:
    """How often synthesized motions like this one were recognized with the right labels."""
    quality = synthesized.quality
    if quality.expected_hit is None:
        return "not measured"
    return (
        f"{quality.expected_hit:.0%} of {quality.expected_trials} held-out motions, made from"
        f" {quality.expected_given} takes{_real_accuracy(quality.real_hit)}"
    )


def _real_accuracy(share: float | None) -> str:
    return "" if share is None else f"; of real takes {share:.0%}"


def _real_skate(speed: float | None) -> str:
    return "" if speed is None else f", in real takes {speed:.2f} m/s"


def _file_name(name: str) -> str:
    """`name` as a valid file name on every system: other characters become "_"."""
    return "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in name).strip(" .")[:100]
