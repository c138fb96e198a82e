"""While somebody holds the files of a library, no process may remove one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from app.store.files.removal_hold import FolderHold

_HOLDER = """
import pathlib, sys, time
from app.store.files.removal_hold import FolderHold
with FolderHold(pathlib.Path(sys.argv[1])).held():
    print("held", flush=True)
    time.sleep(600)
"""


def may_remove(folder: Path) -> bool:
    with FolderHold(folder).free() as is_free:
        return is_free


def test_files_are_free_again_after_the_last_holder(tmp_path: Path) -> None:
    assert may_remove(tmp_path)
    with FolderHold(tmp_path).held():
        assert not may_remove(tmp_path)
        with FolderHold(tmp_path).held():
            assert not may_remove(tmp_path)
        assert not may_remove(tmp_path)
    assert may_remove(tmp_path)


def test_the_hold_of_a_killed_process_ends_with_it(tmp_path: Path) -> None:
    holder = subprocess.Popen(
        [sys.executable, "-c", _HOLDER, str(tmp_path)], stdout=subprocess.PIPE
    )
    assert holder.stdout is not None
    with holder, holder.stdout:
        assert holder.stdout.readline() == b"held\n"
        assert not may_remove(tmp_path)
        holder.send_signal(signal.SIGKILL)
    assert may_remove(tmp_path)


def test_a_folder_in_which_nothing_can_be_written_stops_no_copy(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    with FolderHold(gone).held():
        assert may_remove(gone)


def test_a_file_system_without_locks_stops_neither(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(descriptor: int, operation: int) -> None:
        raise OSError(38, os.strerror(38))

    monkeypatch.setattr("fcntl.flock", fail)
    with FolderHold(tmp_path).held():
        assert may_remove(tmp_path)
