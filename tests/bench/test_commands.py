"""CPU time of commands from start to end. Nearly all of it is imports.

Run: pytest -m bench -s tests/bench/test_commands.py
The program as a user starts it, over a library of 500 copies of real clips. The peer is a Python
that imports the libraries that a search needs, and ends: numpy, sqlalchemy, fastapi, httpx2 and
typer. Seconds of CPU differ by a factor of two between runs of one machine, so the limits are
multiples of the peer's time. The targets of issue 13, on the machine where it was measured: 0.3 s
for --version and --help, 1 s for a search.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
from itertools import product
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
    "commands", "CPU time of commands", trials="seven runs of each command in turn; 500 clips"
)

pytestmark = pytest.mark.bench

CLIPS, RUNS = 500, 7
FIRST = f"clip_{0:020x}"
LIBRARIES = "import numpy, sqlalchemy, fastapi, httpx2, typer"
COMMANDS = {
    ("--version",): 0.3,
    ("--help",): 0.5,
    ("search", "--help"): 0.9,
    ("search", FIRST): 2.5,
    ("search", FIRST, "--method", "vector"): 2.5,
    ("search", FIRST, "--method", "dtw"): 2.5,
}
"""Limit of each command, as a multiple of the peer's time."""


def test_commands_start_at_once(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "data")
    identity.prepare(settings.database, settings.files_dir)
    store = Store.open(settings.database, settings.files_dir)
    fill(store, CLIPS, names=(FEATURES, RHO, EPSILON))
    store.close()
    kinedex = str(Path(sys.executable).with_name("kinedex"))
    programs = {words: [kinedex, *words] for words in COMMANDS}
    programs["peer",] = [sys.executable, "-c", LIBRARIES]
    taken: dict[tuple[str, ...], list[float]] = {words: [] for words in programs}
    for _, (words, program) in product(range(RUNS), programs.items()):
        taken[words].append(_cpu(program, settings.data_dir))
    peer = min(taken["peer",])
    FIGURES.print(f"\n{'seconds of CPU':36}{'least':>8}{'median':>8}{'of peer':>9}{'limit':>7}")
    for words, runs in taken.items():
        shown = f"kinedex {' '.join(words)}".replace(FIRST, "CLIP")
        name = "the libraries alone" if words == ("peer",) else shown
        limit = f"{COMMANDS[words]:7.1f}" if words in COMMANDS else ""
        least, median = min(runs), statistics.median(runs)
        FIGURES.print(f"{name:36}{least:8.2f}{median:8.2f}{least / peer:9.2f}{limit}")
    assert {w for w, limit in COMMANDS.items() if min(taken[w]) > limit * peer} == set()


def _cpu(program: list[str], data_dir: Path) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    env = environment(data_dir=data_dir)
    subprocess.run(program, env=env, capture_output=True, check=True, timeout=120)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
