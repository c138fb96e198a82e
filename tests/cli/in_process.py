"""Runs a command in the process of the tests, on an existing library."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result
from typer.testing import CliRunner

from app.cli.main import program
from app.services.library.library import Library

Run = Callable[..., Result]


def running(command: str, lib: Library, folder: Path, patched: pytest.MonkeyPatch) -> Run:
    """A function that runs `kinedex COMMAND ...` on the library, in `folder`."""
    patched.chdir(folder)
    data_dir = str(lib.settings.data_dir)

    def run(*arguments: str) -> Result:
        return CliRunner().invoke(program, ["--data-dir", data_dir, command, *arguments])

    return run
