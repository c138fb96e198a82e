"""Figures of the methods on the library's own labels."""

from __future__ import annotations

import typer

from app.cli.commands import EVALUATIONS
from app.cli.lazy import lazy_group

program = typer.Typer(
    cls=lazy_group(EVALUATIONS), help="Figures on your own library.", no_args_is_help=True
)
