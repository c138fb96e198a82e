"""The command that makes a new clip from a stored clip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.output import AsJson, print_json
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.bodies import Step

PLAIN = ("mirror", "in-place")
"""Steps without values."""


def edit(
    context: typer.Context,
    clip_id: Annotated[str, typer.Argument(help="The id of a clip.")],
    steps: Annotated[
        list[str],
        typer.Argument(
            metavar="STEP...",
            help="Done one after the other: cut=START:END (seconds; either may be left out),"
            " mirror, resample=FPS, in-place, loop or loop=SHORTEST:LONGEST (seconds).",
        ),
    ],
    name: Annotated[str | None, typer.Option(help="The name of the new clip.")] = None,
    as_json: AsJson = False,
) -> None:
    """Make a new clip from a clip: cut, mirrored, at another rate, in place, or as a loop.

    A worker analyzes the new clip. It carries the labels over; a mirrored one, with left and right
    exchanged. Example: kinedex edit CLIP_ID cut=0.5:2 mirror in-place
    """
    parsed = [_step(text) for text in steps]
    with open_client(context) as client:
        made = client.clips.edit(clip_id, parsed, name=name)
    if as_json:
        print_json(made.to_json())
        return
    state = made.clip.state if made.job is None else f"queued as {made.job.id}"
    typer.echo(f"{made.clip.id}: {made.clip.name} ({state})")


def _step(text: str) -> Step:
    """A step as the API takes it. Raises BadParameter."""
    kind, _, value = text.partition("=")
    if kind in PLAIN and not value:
        return _made(kind.replace("-", "_"))
    if kind == "resample":
        return _made(kind, fps=_number(text, value))
    if kind in ("cut", "loop"):
        names = ("start", "end") if kind == "cut" else ("min_seconds", "max_seconds")
        parts = zip(names, value.split(":"), strict=False)
        return _made(kind, **{name: _number(text, part) for name, part in parts if part})
    raise _wrong(text)


def _made(kind: str, **values: float) -> Step:
    step: Any = {"kind": kind, **values}
    made: Step = step
    return made


def _number(text: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise _wrong(text) from None


def _wrong(text: str) -> typer.BadParameter:
    steps = "cut=START:END, mirror, resample=FPS, in-place, loop or loop=SHORTEST:LONGEST"
    return typer.BadParameter(f"{text!r}: a step is {steps}", param_hint="STEP")
