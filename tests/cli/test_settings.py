"""Starts that are refused, and wrong settings: the user must understand each message."""

from __future__ import annotations

import socket
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tests.cli.conftest import Kinedex, end, start


def test_serving_beyond_this_machine_needs_a_key(tmp_path: Path) -> None:
    data_dir = tmp_path / "data"
    refused = end(start("serve", "--host", "0.0.0.0", "--port", "0", data_dir=data_dir))
    assert refused.code == 1
    assert "kinedex keys create" in refused.err
    assert "Traceback" not in refused.err


def test_the_message_names_a_wrong_setting_without_its_value(
    kinedex: Kinedex, tmp_path: Path
) -> None:
    ended = kinedex("serve", port="hunter2", data_dir=tmp_path / "data")
    assert ended.code == 1
    assert "KINEDEX_PORT" in ended.err
    assert "hunter2" not in ended.err
    assert not (tmp_path / "data").exists()


@pytest.mark.parametrize("command", ["serve", "demo"])
def test_a_port_in_use_is_refused_at_once(kinedex: Kinedex, tmp_path: Path, command: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        ended = kinedex(command, port=port, data_dir=tmp_path / "data")
    assert ended.code == 1
    assert f"port {port}" in ended.err
    assert ended.out == ""


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"data_dir": "/dev/null/data"}, "/dev/null/data"),
        ({"database_url": "nonsense"}, "KINEDEX_DATABASE_URL"),
        ({"database_url": "nosuch://base"}, "nosuch"),
    ],
)
def test_a_library_that_cannot_be_opened_gets_a_clear_message(
    kinedex: Kinedex, settings: dict[str, str], expected: str
) -> None:
    ended = kinedex("keys", "list", **settings)
    assert ended.code == 1
    assert expected in ended.err
    assert "Traceback" not in ended.err


def test_a_file_that_is_not_a_database_is_refused(kinedex: Kinedex, tmp_path: Path) -> None:
    (tmp_path / "kinedex.sqlite3").write_bytes(b"no database at all, " * 100)
    ended = kinedex("keys", "list", data_dir=tmp_path)
    assert ended.code == 1
    assert "not a database" in ended.err


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ("UPDATE alembic_version SET version_num = '9999'", "newer Kinedex"),
        ("DELETE FROM alembic_version", "no schema version"),
    ],
)
def test_a_failed_upgrade_prints_the_reason(
    kinedex: Kinedex, tmp_path: Path, change: str, expected: str
) -> None:
    assert kinedex("db", "upgrade", data_dir=tmp_path).code == 0
    with closing(sqlite3.connect(tmp_path / "kinedex.sqlite3")) as database:
        database.execute(change)
        database.commit()
    ended = kinedex("db", "upgrade", data_dir=tmp_path)
    assert (ended.code, ended.out) == (1, "")
    assert expected in ended.err
    assert kinedex("keys", "list", data_dir=tmp_path).code == 1


def test_each_wrong_setting_is_named(kinedex: Kinedex) -> None:
    ended = kinedex("keys", "list", max_frames=0, job_poll_s="soon")
    assert ended.code == 1
    assert "KINEDEX_MAX_FRAMES" in ended.err
    assert "KINEDEX_JOB_POLL_S" in ended.err


def test_a_flag_has_priority_over_the_environment(kinedex: Kinedex, tmp_path: Path) -> None:
    (tmp_path / "flag").mkdir()
    flag = ("--data-dir", str(tmp_path / "flag"))
    assert kinedex(*flag, "keys", "create").code == 0
    assert kinedex("keys", "create", *flag).code == 0
    keys = kinedex("keys", "list", f"--data-dir={tmp_path / 'flag'}", "--json").json()
    assert len(keys) == 2


@pytest.mark.parametrize(
    "words",
    [
        ("keys", "list"),
        ("keys", "create"),
        ("search", "--words", "kick"),
        ("clips", "list"),
        ("jobs", "list"),
        ("status",),
        ("fit",),
        ("reanalyze",),
        ("verify",),
        ("db", "upgrade"),
        ("backup", "copy"),
        ("export", "x"),
        ("evaluate", "words"),
        ("worker",),
    ],
    ids=" ".join,
)
def test_a_wrong_name_of_the_data_directory_makes_no_library(
    words: tuple[str, ...], kinedex: Kinedex, tmp_path: Path
) -> None:
    ended = kinedex(*words, "--data-dir", str(tmp_path / "typo"))
    assert (ended.code, ended.out) == (1, "")
    assert ended.err.count("typo: the folder does not exist") == 1
    assert not (tmp_path / "typo").exists()


@pytest.mark.parametrize("words", [("keys", "list"), ("status",)], ids=" ".join)
def test_a_command_that_reads_makes_no_library_in_an_empty_folder(
    words: tuple[str, ...], kinedex: Kinedex, tmp_path: Path
) -> None:
    ended = kinedex(*words, data_dir=tmp_path)
    assert (ended.code, ended.err) == (1, f"kinedex: There is no library in {tmp_path}.\n")
    assert list(tmp_path.iterdir()) == []


def test_the_version_and_the_commands_are_printed(kinedex: Kinedex) -> None:
    assert kinedex("--version").out.startswith("kinedex ")
    listed = kinedex("--help").out
    for command in ("serve", "import", "search", "recognize", "fit", "evaluate", "keys", "db"):
        assert command in listed


def test_an_unknown_command_is_a_usage_error(kinedex: Kinedex) -> None:
    ended = kinedex("dance")
    assert ended.code == 2
    assert "dance" in ended.err
