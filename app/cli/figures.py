"""Held-out figures of models, as names and shares."""

from __future__ import annotations

from typing import Any

COUNT_SUFFIX = "clips"
"""Figures whose names end like this are counts, not shares."""
CURVE = "curve"
"""Figures at many thresholds. They are for programs: no table shows them."""
MAIN = {
    "keyposes": "methods rms learned f",
    "metric-person": "persons_held_out mean_average_precision",
    "metric-task": "tasks_held_out mean_average_precision",
    "perera": "unknown person balanced_accuracy",
    "recognizer": "held_out default task",
    "signatures": "held_out signatures task",
    "synthesis": "held_out new_task person",
    "words": "figures default top_3_recognition",
}
"""The figure that stands for a kind of model if there is place for only one."""


def shares(figures: Any, path: str = "") -> list[tuple[str, float | None]]:
    """The shares in nested figures, named by their path. Counts are left out.

    path: the names of the dictionaries that contain `figures`, joined by spaces.
    """
    if isinstance(figures, list):
        return [share for one in figures for share in shares(one, path)]
    if not isinstance(figures, dict):
        is_share = isinstance(figures, float) and not path.endswith(COUNT_SUFFIX)
        return [(path, figures)] if is_share else []
    name = f"{path} {figures.get('method', '')}".strip()
    parts = [(key, value) for key, value in figures.items() if key != CURVE]
    return [share for key, value in parts for share in shares(value, f"{name} {key}".strip())]


def main_figure(kind: str, figures: Any) -> tuple[str | None, float | None]:
    """The figure that stands for a kind of model, with its name; (None, None) without it."""
    name = MAIN.get(kind)
    return next(((name, value) for one, value in shares(figures) if one == name), (None, None))
