"""CPU time of commands from start to end. Nearly all of it is imports.

Run: pytest -m bench -s tests/bench/test_commands.py
The program as a user starts it, over a library of 500 copies of real clips. Targets (issue 13):
0.3 s for --version and --help, 1 s for a search; 0.4 s for the help of one command, because typer
imports pydantic then. On a busy machine the same work may take half as long again, so the test
allows for that.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
from pathlib import Path

import pytest

from app.config import Settings
from app.search.example.distances import EPSILON, FEATURES, RHO
from app.store import identity
from app.store.store import Store
from tests.bench.large_library import fill
from tests.bench.page import Section
from tests.cli.conftest import environment

FIGURES = Section(
    "commands", "CPU time of commands", trials="seven runs of each command; 500 clips"
)

pytestmark = pytest.mark.bench

CLIPS, RUNS = 500, 7
FIRST = f"clip_{0:020x}"
COMMANDS = {
    ("--version",): 0.3,
    ("--help",): 0.3,
    ("search", "--help"): 0.4,
    ("search", FIRST): 1.0,
    ("search", FIRST, "--method", "vector"): 1.0,
    ("search", FIRST, "--method", "dtw"): 1.0,
}
"""Target of each command, CPU seconds."""
AT_WORK = 1.5
"""Allowed factor over a target, because the machine may be busy."""


def test_commands_start_at_once(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "data")
    identity.prepare(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir)
    fill(store, CLIPS, names=(FEATURES, RHO, EPSILON))
    store.close()
    FIGURES.print(f"\n{'seconds of CPU':36}{'least':>8}{'median':>8}{'target':>8}")
    taken = {}
    for words, target in COMMANDS.items():
        runs = [_cpu(words, settings.data_dir) for _ in range(RUNS)]
        taken[words] = min(runs)
        shown = f"kinedex {' '.join(words)}".replace(FIRST, "CLIP")
        FIGURES.print(f"{shown:36}{min(runs):8.2f}{statistics.median(runs):8.2f}{target:8.1f}")
    assert {w for w, target in COMMANDS.items() if taken[w] > AT_WORK * target} == set()


def _cpu(words: tuple[str, ...], data_dir: Path) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    program = str(Path(sys.executable).with_name("kinedex"))
    env = environment(data_dir=data_dir)
    subprocess.run([program, *words], env=env, capture_output=True, check=True, timeout=120)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
