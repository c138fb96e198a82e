"""Other processes of the same machine see from the name of an owner whether it is dead."""

from __future__ import annotations

import subprocess
import sys

import pytest

from app.store.jobs import owners

NAME = "from app.store.jobs.owners import new_owner; print(new_owner('worker'), flush=True);"


def test_only_an_ended_process_is_gone() -> None:
    assert not owners.is_gone(owners.new_owner("worker"))
    command = [sys.executable, "-c", NAME + "input()"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        name = process.stdout.readline().decode().strip()
        assert not owners.is_gone(name)
        process.kill()
        # It is a zombie until its parent waits for it, but it is dead.
        assert process.stdout.read() == b""
        process.wait()
        assert owners.is_gone(name)


def test_another_process_with_the_same_number_is_another_owner() -> None:
    name = owners.new_owner("worker")
    assert owners.is_gone(f"{name}1")


@pytest.mark.parametrize("part", ["@", "/", "pid:"])
def test_owners_on_other_machines_never_count_as_dead(part: str) -> None:
    name = owners.new_owner("worker")
    elsewhere = name.replace(part, f"{part}other") + "1"
    assert not owners.is_gone(elsewhere)
    for strange in ("", "worker", "worker@host:12", "a@b:c:d", "a@b:1:"):
        assert not owners.is_gone(strange)
