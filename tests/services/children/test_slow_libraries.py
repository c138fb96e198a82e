"""hmmlearn and scikit-learn are loaded by those who fit with them, and by nobody else."""

from __future__ import annotations

import importlib
import subprocess
import sys
from multiprocessing.queues import Queue

import pytest

from app.services.children.processes import LIBRARIES, child_context

SLOW = ("hmmlearn", "sklearn")


def test_commands_the_api_and_the_worker_start_without_them() -> None:
    code = (
        "import sys, app.cli, app.api.app, app.worker.__main__;"
        f"print(*(name for name in {SLOW} if name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("name", LIBRARIES)
def test_each_library_of_the_children_exists(name: str) -> None:
    """The server process says nothing of one that does not: it would just be slow."""
    importlib.import_module(name)


def test_the_children_find_them_loaded() -> None:
    context = child_context()
    answers = context.Queue()
    child = context.Process(target=_tell, args=(answers,))
    child.start()
    try:
        assert answers.get(timeout=60) == dict.fromkeys(SLOW, True)
    finally:
        child.join()


def _tell(answers: Queue[dict[str, bool]]) -> None:
    answers.put({name: name in sys.modules for name in SLOW})
