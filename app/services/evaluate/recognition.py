"""Who does what (Vasilescu, Perera 5), held out."""

from __future__ import annotations

from app.models.recognition_figures import held_out_recognition_figures
from app.services.library import Library
from app.services.training import read_training_set, ready_only
from app.store.clip_filter import ClipFilter


def judge_recognition(
    lib: Library, wanted: ClipFilter | None = None
) -> dict[str, dict[str, float]]:
    """Held-out shares recognised by method: person, task, both; beside the prior."""
    training = read_training_set(lib.store, ready_only(wanted))
    return held_out_recognition_figures(
        training.samples, training.persons, training.tasks, training.groups
    )
