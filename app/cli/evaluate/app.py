"""The group of commands that measure the methods on the labels of the library."""

from __future__ import annotations

import typer

from app.cli.commands import EVALUATIONS
from app.cli.lazy import lazy_group

program = typer.Typer(
    cls=lazy_group(EVALUATIONS),
    help="Measure the methods on your own library.",
    no_args_is_help=True,
)
