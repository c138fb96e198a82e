"""One process at a time uses the folder of compiled code."""

from __future__ import annotations

import multiprocessing
import time
from pathlib import Path

import pytest

from app.services.library.compiled_code import compiled_code


def _note(folder: str, log: str) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("NUMBA_CACHE_DIR", folder)
        with compiled_code(), Path(log).open("a") as lines:
            lines.write("in\n")
            lines.flush()
            time.sleep(0.2)
            lines.write("out\n")


def test_processes_take_turns(tmp_path: Path) -> None:
    log = tmp_path / "log"
    spawned = multiprocessing.get_context("spawn")
    processes = [spawned.Process(target=_note, args=(str(tmp_path), str(log))) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert log.read_text().split() == ["in", "out"] * 3


def test_without_a_folder_nobody_waits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in ("", str(tmp_path / "missing")):
        monkeypatch.setenv("NUMBA_CACHE_DIR", folder)
        with compiled_code(), compiled_code():
            pass
