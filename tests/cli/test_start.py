"""Commands start fast: the modules that they import, and their CPU time."""

from __future__ import annotations

import inspect
import json
import resource
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from app.cli.commands import COMMANDS, EVALUATIONS
from app.cli.lazy import CommandEntry
from tests.cli.conftest import Kinedex, environment

PROGRAM = """
import atexit, json, sys
sys.argv[0] = "kinedex"
atexit.register(lambda: print("\\n" + json.dumps(sorted(sys.modules)), file=sys.stderr))
from app.cli import main
main()
"""
DATABASE = {"sqlalchemy", "alembic"}
WEB = {"fastapi", "starlette"}
PARTS = ("fft", "interpolate", "linalg", "ndimage", "optimize", "signal", "stats")
SLOW = {"sklearn", "hmmlearn", "matplotlib", "librosa", "numba"}
SCIENCE = {f"scipy.{part}" for part in PARTS} | SLOW
"""`import scipy` alone is quick: it imports each part when that is first used."""
CHOICES_NEED_NUMPY = {"search-pose", "export"}
"""Commands with an option whose choices are defined in a module that imports NumPy."""


@dataclass(frozen=True)
class Run:
    """The output of one command, the modules that it imported, and its CPU time in seconds."""

    out: str
    modules: frozenset[str]
    cpu: float

    def imported(self, packages: set[str]) -> list[str]:
        return sorted(packages & self.modules)


def run(*words: str, **settings: object) -> Run:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words],
        env=environment(**settings),
        capture_output=True,
        text=True,
        timeout=400,
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(ended.stdout, frozenset(json.loads(ended.stderr.splitlines()[-1])), cpu)


@pytest.mark.parametrize("flag", ["--version", "--help"])
def test_version_and_help_import_no_slow_library(flag: str) -> None:
    found = run(flag)
    slow = DATABASE | WEB | SCIENCE | {"numpy", "scipy", "pydantic", "pydantic_settings"}
    assert found.imported(slow) == []
    # 0.1 and 0.2 s on an idle machine; all commands together take more than 1 s to import.
    assert found.cpu < 0.8


def test_help_lists_every_command_with_its_line() -> None:
    shown = " ".join(run("--help", columns=200).out.replace("│", " ").split())
    assert [name for name in COMMANDS if f" {name} " not in shown] == []
    assert [p.help for p in COMMANDS.values() if " ".join(p.help.split()[:4]) not in shown] == []


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_imports_neither_scipy_nor_a_database(name: str) -> None:
    found = run(name, "--help")
    assert f"Usage: kinedex {name} " in found.out
    slow = DATABASE | WEB | SCIENCE | (set() if name in CHOICES_NEED_NUMPY else {"numpy"})
    assert found.imported(slow) == []
    assert found.cpu < 1.2


@pytest.mark.parametrize(
    "words", [("{id}",), ("{id}", "--method", "vector"), ("--words", "kick")], ids="-".join
)
def test_a_search_imports_only_what_it_needs(
    words: Sequence[str], kinedex: Kinedex, data_dir: Path
) -> None:
    clip = kinedex("search", "--words", "kick", "--limit", "1", "--json").json()["items"][0]["clip"]
    found = run("search", *(word.format(id=clip["id"]) for word in words), data_dir=data_dir)
    assert "rank" in found.out
    assert found.imported(SCIENCE | {"alembic"}) == []
    others = ("app.api.app", "app.api.routes.synthesize", "app.api.routes.studies")
    assert found.imported(set(others)) == []  # only the routes of the search


@pytest.mark.parametrize(
    ("name", "entry"), [*COMMANDS.items(), *((f"evaluate {n}", p) for n, p in EVALUATIONS.items())]
)
def test_the_line_of_a_command_is_the_first_line_of_its_help(
    name: str, entry: CommandEntry
) -> None:
    command = entry.load(name.split()[-1])
    assert isinstance(command.help, str)
    assert inspect.cleandoc(command.help).split("\n\n")[0].replace("\n", " ") == entry.help
