"""Figures of the methods on the library's own labels."""

from __future__ import annotations

import typer

from app.cli.evaluate_keyposes import keyposes
from app.cli.evaluate_low_dimensional import low_dimensional
from app.cli.evaluate_recognition import recognition
from app.cli.evaluate_retrieval import retrieval
from app.cli.evaluate_symbols import symbols
from app.cli.evaluate_words import words

program = typer.Typer(help="Figures on your own library.", no_args_is_help=True)
program.command("retrieval")(retrieval)
program.command("keyposes")(keyposes)
program.command("low-dimensional")(low_dimensional)
program.command("symbols")(symbols)
program.command("recognition")(recognition)
program.command("words")(words)
