"""A confusion matrix as text."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from app.numerics.arrays import FloatArray
from app.services import pictures


def print_confusion(classes: Sequence[str], shares: FloatArray) -> None:
    """`shares` (C, C), 0..1, as per cent; a row is a true class, columns are their numbers.

    Lines are not broken, however many classes there are.
    """
    names = [f"{number:>2} {pictures.shown(name)}" for number, name in enumerate(classes, 1)]
    width = max(map(len, names), default=0)
    typer.echo(" " * width + "".join(f"{number:>4}" for number in range(1, len(names) + 1)))
    for name, row in zip(names, shares, strict=True):
        cells = [f"{100 * share:>4.0f}" if share >= 0.005 else "   ." for share in row]
        typer.echo(f"{name:<{width}}" + "".join(cells))
