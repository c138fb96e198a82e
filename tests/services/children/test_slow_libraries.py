"""Only processes that fit models load hmmlearn and scikit-learn, which are slow to import."""

from __future__ import annotations

import importlib
import subprocess
import sys
from multiprocessing.queues import Queue

import pytest

from app.services.children.processes import LIBRARIES, child_context

SLOW = ("hmmlearn", "sklearn")


def test_the_commands_the_api_and_the_worker_start_without_slow_libraries() -> None:
    code = (
        "import sys, app.cli, app.api.app, app.worker.__main__;"
        f"print(*(name for name in {SLOW} if name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("name", LIBRARIES)
def test_each_library_of_the_children_exists(name: str) -> None:
    """The server process ignores a missing library without an error, and children become slow."""
    importlib.import_module(name)


def test_children_start_with_the_core_of_hmmlearn_but_without_scikit_learn() -> None:
    context = child_context()
    answers = context.Queue()
    child = context.Process(target=_report_loaded, args=(answers,))
    child.start()
    try:
        assert answers.get(timeout=300) == {"hmmlearn": True, "sklearn": False}
    finally:
        child.join()


def _report_loaded(answers: Queue[dict[str, bool]]) -> None:
    answers.put({name: name in sys.modules for name in SLOW})
