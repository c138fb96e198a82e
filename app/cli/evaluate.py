"""Figures of the methods on the library's own labels."""

from __future__ import annotations

import typer

program = typer.Typer(help="Figures on your own library.", no_args_is_help=True)
