"""An upgrade that is killed before any of its statements changes nothing, and can be repeated."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from app.config import sqlite_url
from app.store.database import schema
from app.store.database.engine import Database
from app.store.upkeep.backup import DATABASE
from tests.first_library import FIRST, made_motion, make_first_library, rows_of

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("every", [25, pytest.param(1, marks=pytest.mark.slow)])
def test_a_killed_upgrade_has_changed_nothing(tmp_path: Path, every: int) -> None:
    make_first_library(tmp_path / "data", [made_motion("walk")])
    original = tmp_path / "data" / DATABASE
    before, folder = rows_of(original), tmp_path / "killed"
    folder.mkdir()
    command = [sys.executable, "-m", "tests.faults.killed_upgrade"]
    subprocess.run([*command, str(original), str(folder), str(every)], cwd=ROOT, check=True)
    killed = sorted(folder.glob("killed-*.sqlite3"), key=lambda path: int(path.stem[7:]))
    assert len(killed) * every > 100
    for path in killed:
        database = Database.at(path)
        assert database.find_damage() == ()
        database.close()
        assert rows_of(path) == before
    for path in (killed[0], killed[len(killed) // 2], killed[-1]):
        assert schema.state(sqlite_url(path)).current == FIRST
        assert schema.upgrade(sqlite_url(path)).is_current
        assert len(rows_of(path)["clips"]) == len(before["clips"])
