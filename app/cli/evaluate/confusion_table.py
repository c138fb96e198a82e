"""A confusion matrix as text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import typer

from app.cli.evaluate.tables import keep_table
from app.cli.output import MAX_WIDTH, print_table
from app.evaluate import charts as pictures
from app.numerics.arrays import FloatArray

MAX_PAIRS = 25
"""Largest number of printed confusions."""
MIN_SHARE = 0.005
"""The smallest share that is printed: it rounds to one percent."""


def print_confusion(classes: Sequence[str], shares: FloatArray, table: str = "confusion") -> None:
    """Print `shares` (C, C), 0..1, in percent; a row is a true class, columns have its number.

    If the table would be wider than MAX_WIDTH, print the most frequent confusions instead. All
    shares go to the CSV file, as the table of that name.
    """
    every = np.ndindex(*shares.shape)
    rows = [[classes[true], classes[taken], shares[true, taken]] for true, taken in every]
    keep_table(table, ["true", "taken for", "share"], rows)
    names = [f"{number:>2} {pictures.shown(name)}" for number, name in enumerate(classes, 1)]
    width = max(map(len, names), default=0)
    if width + 4 * len(names) > MAX_WIDTH:
        _print_largest(classes, shares)
        return
    typer.echo(" " * width + "".join(f"{number:>4}" for number in range(1, len(names) + 1)))
    for name, row in zip(names, shares, strict=True):
        cells = [f"{100 * share:>4.0f}" if share >= MIN_SHARE else "   ." for share in row]
        typer.echo(f"{name:<{width}}" + "".join(cells))


def _print_largest(classes: Sequence[str], shares: FloatArray) -> None:
    """Print the pairs of confused classes, the most frequent first."""
    confused = shares * ~np.eye(len(classes), dtype=bool)
    order = np.argsort(-confused, axis=None, kind="stable")
    pairs = [divmod(int(index), len(classes)) for index in order]
    confusions = [pair for pair in pairs if confused[pair] >= MIN_SHARE]
    shown = confusions[:MAX_PAIRS]
    if shown:
        print_table(
            ["true", "taken for", "%", "right, %"], [_row(classes, shares, *p) for p in shown]
        )
        typer.echo("")
    typer.echo(
        f"{len(classes)} classes, {_count_text(len(shown), len(confusions))};"
        " --json, --csv and --pictures have the whole matrix."
    )


def _count_text(shown: int, confusions: int) -> str:
    if not confusions:
        return "no confusion"
    return (
        f"all {confusions} confusions"
        if shown == confusions
        else f"the {shown} largest of {confusions} confusions"
    )


def _row(classes: Sequence[str], shares: FloatArray, true: int, taken: int) -> list[object]:
    names = [pictures.shown(classes[true]), pictures.shown(classes[taken])]
    return [*names, *(round(100 * shares[true, one]) for one in (taken, true))]
