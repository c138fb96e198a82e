"""Ten times `kill -9` of the worker during an import: no clip is lost, and none exists twice.

Run: pytest -m bench -s tests/bench/test_kill.py
Every second kill ends only the worker's own process, so that its children must end by themselves.
The other kills end the whole tree at once. `kinedex serve` starts the worker again each time.
"""

from __future__ import annotations

import os
import random
import sqlite3
import time
from collections import Counter
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.bench.page import Section
from tests.bench.processes import Key, child_running, key_of, kill, processes_over, tree_of
from tests.bench.product import WORKER, Product, serving, zip_of_real_clips
from tests.live import wait_until
from tests.real_clips import manifest

FIGURES = Section(
    "kill",
    "Ten kills of the worker during an import",
    trials="ten `kill -9` during one import of all real clips",
)

pytestmark = pytest.mark.bench

KILLS = 10
SEED = 9
IMPORT_SECONDS = 900.0
ORPHANS_END_WITHIN = 5.0
DIED = "worker_died"
"""The code of a clip that failed because its worker died. No clip may have it here."""


@dataclass
class Tally:
    """The kills, the job with its files, and the processes that remained."""

    at: list[str] = field(default_factory=list)
    orphans: set[Key] = field(default_factory=set)
    job: dict[str, Any] = field(default_factory=dict)
    files: list[dict[str, Any]] = field(default_factory=list)
    seconds: float = 0.0
    left_running: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Tally, Path]:
    folder = tmp_path_factory.mktemp("kill")
    archive = zip_of_real_clips(folder / "clips.zip")
    tally, data = Tally(), folder / "data"
    with serving(data, log_level="warning") as product:
        began = time.monotonic()
        job = product.start_import(archive)
        draw = random.Random(SEED)
        for number in range(KILLS):
            _wait_for_clips(product, number * len(manifest()) // (KILLS + 1))
            time.sleep(draw.uniform(0.0, 1.0))
            _kill_worker(product, tally, whole=number % 2 == 1)
        tally.job = product.wait_for_job(job, IMPORT_SECONDS)
        tally.files = product.items(f"/v1/jobs/{job}/files")
        tally.seconds = time.monotonic() - began
    tally.left_running = [" ".join(p.cmdline()) for p in processes_over(data)]
    return tally, data


def _ended(product: Product) -> int:
    """Clips that are ready or failed."""
    with closing(_database(product.data_dir)) as database:
        query = "select count(*) from clips where state in ('ready', 'failed')"
        return int(database.execute(query).fetchone()[0])


def _wait_for_clips(product: Product, count: int) -> None:
    """Wait until more than `count` clips have ended and a worker processes the next one."""

    def is_at_work() -> bool:
        worker = child_running(product.supervisor, WORKER)
        return worker is not None and len(tree_of(worker)) > 1 and _ended(product) > count

    wait_until(is_at_work, IMPORT_SECONDS)


def _kill_worker(product: Product, tally: Tally, *, whole: bool) -> None:
    worker = child_running(product.supervisor, WORKER)
    assert worker is not None
    tree = tree_of(worker)
    keys = {key_of(process) for process in tree}
    kill(tree if whole else tree[:1])
    tally.at.append(f"{'tree' if whole else 'main'} of {len(tree)} at {_ended(product)}")
    psutil.wait_procs(tree, timeout=ORPHANS_END_WITHIN)
    tally.orphans |= {key_of(process) for process in tree if process.is_running()} & keys


def _database(data: Path) -> sqlite3.Connection:
    return sqlite3.connect(f"file:{data / 'kinedex.sqlite3'}?mode=ro", uri=True)


def test_every_clip_ends_exactly_once(killed: tuple[Tally, Path]) -> None:
    tally, data = killed
    files = tally.files
    outcomes = Counter(file["outcome"] for file in files)
    failures = Counter(file["error"]["code"] for file in files if file["error"])
    FIGURES.print(f"\n{KILLS} kills in {tally.seconds:.0f} s (load {os.getloadavg()[0]:.1f})")
    FIGURES.print("  killed: " + "; ".join(tally.at))
    FIGURES.print(f"  files {len(files)}: {dict(outcomes)}; reasons {dict(failures)}")
    assert tally.job["state"] == "succeeded"
    counts = Counter(file["path"] for file in files)
    assert {row["path"]: counts[row["path"]] for row in manifest()} == {
        row["path"]: 1 for row in manifest()
    }
    assert outcomes.keys() <= {"ready", "failed", "unchanged", "skipped"}
    assert DIED not in failures
    with closing(_database(data)) as database:
        _check_clips(database, [file["clip_id"] for file in files if file["clip_id"]])
        _check_jobs(database)
        _check_files(database, data / "files")


def _check_clips(database: sqlite3.Connection, acknowledged: list[str]) -> None:
    states = dict(database.execute("select id, state from clips"))
    assert sorted(states) == sorted(acknowledged)
    assert set(states.values()) <= {"ready", "failed"}
    contents = database.execute("select content_key, count(*) from clips group by 1").fetchall()
    assert all(count == 1 for _, count in contents)
    whole = "select clip_id, count(distinct name) from clip_arrays group by 1"
    arrays = dict(database.execute(whole))
    ready = {clip for clip, state in states.items() if state == "ready"}
    assert arrays.keys() == ready
    assert len(set(arrays.values())) == 1
    FIGURES.print(f"  clips {len(states)}, each once; {len(ready)} ready,", end=" ")
    FIGURES.print(f"with {set(arrays.values())} arrays each")


def _check_jobs(database: sqlite3.Connection) -> None:
    jobs = database.execute(
        "select kind, state, attempts, clip_id, owner from jobs where kind != 'fit'"
    ).fetchall()
    ingests = Counter(clip for kind, _, _, clip, _ in jobs if kind == "ingest")
    again = Counter(attempts for kind, _, attempts, _, _ in jobs if kind == "ingest")
    imports = [attempts for kind, _, attempts, _, _ in jobs if kind == "import"]
    FIGURES.print(
        f"  ingest jobs {len(ingests)}, by attempts {dict(sorted(again.items()))}; ", end=""
    )
    FIGURES.print(f"the import took {imports} attempts")
    assert max(ingests.values()) == 1
    assert len(imports) == 1
    assert {state for _, state, _, _, _ in jobs} <= {"succeeded", "failed"}
    assert all(owner is None for *_, owner in jobs)


def _check_files(database: sqlite3.Connection, folder: Path) -> None:
    """The store has the bytes of each clip once, and no incomplete file."""
    expected = {sha for (sha,) in database.execute("select sha256 from clips")}
    kept = [path for path in folder.rglob("*") if path.is_file() and path.name != "library-id"]
    names = Counter(path.name for path in kept)
    strange = [path.name for path in kept if path.name not in expected]
    FIGURES.print(f"  files kept {len(kept)}, of which left over {len(strange)}: {strange[:3]}")
    assert expected - names.keys() == set()
    assert max(names.values()) == 1
    # The next start removes temporary files. Files without a committed row are in the quarantine.
    # The archive was removed when it was unpacked.
    assert not [name for name in strange if name.startswith("up_")]
    assert len(strange) <= KILLS


def test_no_process_outlives_its_worker(killed: tuple[Tally, Path]) -> None:
    tally, _ = killed
    assert len(tally.at) == KILLS
    assert not tally.orphans
    assert not tally.left_running
