"""The entry point of an evaluation in a child process. It must be fast to import."""

from __future__ import annotations

from app.config import Settings
from app.services.children.progress_file import progress_to
from app.services.evaluations.evaluations import Evaluated
from app.services.evaluations.options import EvaluationKind, EvaluationOptions


def evaluate_in_child(
    settings: Settings, kind: EvaluationKind, options: EvaluationOptions, progress_path: str
) -> Evaluated:
    """Open the library and judge its methods; returns the result to be kept.

    Raises the failures of `run_evaluation`.
    """
    from app.evaluate.run import run_evaluation
    from app.services.library.library import Library

    lib = Library.open(settings, prepare=False)
    try:
        return run_evaluation(lib, kind, options, progress_to(progress_path))
    finally:
        lib.close()
