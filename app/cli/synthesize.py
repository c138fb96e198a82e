"""The command that synthesizes motions that nobody recorded."""

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
    person: Annotated[str | None, typer.Option(help="A person of the library.")] = None,
    clip: Annotated[
        list[str] | None,
        typer.Option(help="The id of a clip of the person; may be given several times."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="BVH file to write; default: its name, in this folder."
        ),
    ] = None,
    seconds: Annotated[float | None, typer.Option(help="Duration; default: the usual one.")] = None,
    store: Annotated[bool, typer.Option("--store", help="Keep the motion as a clip.")] = False,
    as_json: AsJson = False,
) -> None:
    """Make a motion that a person never recorded, as a BVH file, and judge its quality."""
    from app.services.synthesis.synthesize import SynthesisQuery, synthesize

    if (person is None) == (not clip):
        raise typer.BadParameter("give either --person or --clip")
    query = SynthesisQuery(
        task=task,
        person=person,
        clip_ids=tuple(clip) if clip else None,
        seconds=seconds,
        store=store,
    )
    with open_library(context) as lib:
        made = synthesize(lib, query)
    whose = made.person or "someone"
    path = output or Path(f"{_safe(f'{whose} {made.name}')}.bvh")
    write_whole(path, [made.bvh])
    if as_json:
        from app.api.schemas.synthesis import Synthesis

        result = Synthesis.of(made, with_bvh=False).model_dump(mode="json", exclude={"motion"})
        print_json({"path": str(path), "bytes": len(made.bvh)} | result)
        return
    _tell(made, path)


def _tell(made: Synthesized, path: Path) -> None:
    quality = made.quality
    rows: list[tuple[str, object]] = [
        ("file", f"{path}: {len(made.bvh)} bytes, {made.motion.duration:.2f} s"),
        ("made of", _made_of(made)),
        ("nearest real clip", quality.nearest.name if quality.nearest else "gone"),
        ("which is of", f"{quality.nearest_person}, {quality.nearest_task}"),
        ("expected hit", _expectation(made)),
        ("feet slide", f"{quality.skate:.2f} m/s{_of_real_takes(quality.real_skate)}"),
    ]
    if made.clip is not None:
        rows.append(("stored as", made.clip.id))
    print_table(("", ""), rows)


def _made_of(made: Synthesized) -> str:
    from app.services.synthesis.plan import SynthesisKind

    quality = made.quality
    if quality.kind is SynthesisKind.SEEN:
        one = "one of their own takes, which do not agree" if quality.follows else "their own takes"
        return f"{one}: this person did record the task"
    tasks, persons = len(quality.given_tasks), len(quality.given_persons)
    if quality.follows:
        return f"{tasks} of their tasks, after {quality.follows}: takes of this one do not agree"
    return f"{tasks} of their tasks, and {persons} other persons' takes of this one"


def _expectation(made: Synthesized) -> str:
    quality = made.quality
    if quality.expected_hit is None:
        return "not measured"
    return (
        f"{quality.expected_hit:.0%} of {quality.expected_trials} left out, made of"
        f" {quality.expected_given}{_real(quality.real_hit)}"
    )


def _real(share: float | None) -> str:
    return "" if share is None else f"; of real takes {share:.0%}"


def _of_real_takes(real: float | None) -> str:
    return "" if real is None else f", in real takes {real:.2f} m/s"


def _safe(name: str) -> str:
    return "".join(c if c.isalnum() or c in " ._-()+" else "_" for c in name).strip(" .")[:100]
