"""`kinedex doctor` finds what is wrong, and says what to do."""

from __future__ import annotations

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Kinedex


@pytest.fixture
def library(kinedex: Kinedex, data_dir: Path, tmp_path: Path) -> Path:
    """A copy of the library that a test may damage."""
    copy = tmp_path / "copy"
    assert kinedex("backup", str(copy)).code == 0
    return copy


def _problems(kinedex: Kinedex, *words: str, **settings: Any) -> dict[str, dict[str, str]]:
    ended = kinedex("doctor", "--json", *words, **settings)
    checks = json.loads(ended.out)
    problems = {one["check"]: one for one in checks["checks"] if one["level"] == "problem"}
    assert ended.code == (1 if problems else 0)
    assert checks["is_healthy"] == (not problems)
    assert all(one["advice"] for one in problems.values())
    return problems


def test_a_healthy_library_has_no_problem(kinedex: Kinedex) -> None:
    assert _problems(kinedex) == {}
    shown = kinedex("doctor").out
    assert "schema" in shown
    assert "stored files are there" in shown


def test_a_missing_data_directory(kinedex: Kinedex, tmp_path: Path) -> None:
    problems = _problems(kinedex, data_dir=tmp_path / "no")
    assert "does not exist" in problems["data directory"]["found"]
    assert not (tmp_path / "no").exists()


def test_a_wrong_setting(kinedex: Kinedex) -> None:
    assert "KINEDEX_PORT" in _problems(kinedex, port="many")["settings"]["found"]


def test_missing_files(kinedex: Kinedex, library: Path) -> None:
    for file in (library / "files").rglob("*"):
        if file.is_file() and len(file.name) == 64:
            file.unlink()
            break
    assert "1 of " in _problems(kinedex, data_dir=library)["files"]["found"]
    assert "1 of " in _problems(kinedex, "--quick", data_dir=library)["files"]["found"]


def test_damage_is_found_and_mended_from_a_backup(kinedex: Kinedex, library: Path) -> None:
    backup = library.parent / "backup"
    shutil.copytree(library, backup)
    path = next(p for p in (library / "files").rglob("*") if len(p.name) == 64)
    content = path.read_bytes()
    path.write_bytes(bytes([content[0] ^ 1]) + content[1:])
    with closing(sqlite3.connect(library / "kinedex.sqlite3")) as opened:
        opened.execute(
            "UPDATE clip_arrays SET shape = '7' WHERE name = 'positions' AND clip_id ="
            " (SELECT max(clip_id) FROM clip_arrays)"
        )
        opened.commit()
    assert path.name in _problems(kinedex, data_dir=library)["files"]["found"]
    assert _problems(kinedex, "--quick", data_dir=library) == {}
    unmended = _problems(kinedex, "--mend", data_dir=library)
    assert path.name in unmended["files"]["found"]
    assert path.read_bytes() != content
    assert _problems(kinedex, "--mend", "--from", str(backup), data_dir=library) == {}
    assert path.read_bytes() == content
    assert kinedex("reanalyze", data_dir=library).code == 0
    assert kinedex("verify", "--json", data_dir=library).json()["is_whole"]


@pytest.mark.parametrize(
    "words",
    [
        ("--mend", "--quick"),
        ("--from", "a"),
        ("--mend", "--from", "no/backup"),
        ("--mend", "--url", "http://127.0.0.1:9"),
    ],
)
def test_options_that_do_not_fit_are_refused(kinedex: Kinedex, words: tuple[str, ...]) -> None:
    refused = kinedex("doctor", *words)
    assert (refused.code, "Traceback" in refused.err) == (1, False)
    assert words[0].removeprefix("--") in refused.err or "from" in refused.err


def test_an_old_and_a_damaged_database(kinedex: Kinedex, library: Path) -> None:
    database = library / "kinedex.sqlite3"
    with closing(sqlite3.connect(database)) as opened:
        opened.execute("UPDATE alembic_version SET version_num = '0001'")
        opened.commit()
    problem = _problems(kinedex, data_dir=library)["database"]
    assert "kinedex db upgrade" in problem["advice"]
    for name in ("kinedex.sqlite3-wal", "kinedex.sqlite3-shm"):
        (library / name).unlink(missing_ok=True)
    database.write_bytes(b"no database at all, " * 1000)
    assert "database" in _problems(kinedex, data_dir=library)
    shutil.rmtree(library)


def test_jobs_that_no_worker_takes(kinedex: Kinedex, library: Path, folder: Path) -> None:
    file = folder / "ada" / "kick_01.bvh"
    content = file.read_bytes() + b"\n"
    new = library.parent / "new.bvh"
    new.write_bytes(content)
    assert kinedex("import", str(new), "--no-wait", data_dir=library).code == 0
    assert "worker" not in _problems(kinedex, data_dir=library)
    with closing(sqlite3.connect(library / "kinedex.sqlite3")) as opened:
        opened.execute("UPDATE jobs SET created_at = '2020-01-01 00:00:00' WHERE state = 'queued'")
        opened.commit()
    problem = _problems(kinedex, data_dir=library)["worker"]
    assert "kinedex serve" in problem["advice"]
