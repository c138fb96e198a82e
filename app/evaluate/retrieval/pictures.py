"""The figures of Sun 2011 for a library: matrices (3), volumes (5), vectors (6), convergence (7),
confusion (8)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np

from app.evaluate.charts import (
    Curve,
    Format,
    Panel,
    Slices,
    confusions_picture,
    curves_picture,
    matrices_picture,
    volumes_picture,
)
from app.evaluate.retrieval.evaluation import RetrievalEvaluation
from app.evaluate.retrieval.volumes import VolumeEvaluation
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1
from app.search.example.methods import Method

SIDE_BY_SIDE = (Method.MSV_XCORR, Method.MSV_DTW, Method.FUSED)
"""The two methods of figure 8, and the default method of searches."""
ENOUGH_ITERATIONS = 5
"""Sufficient number of iterations according to the paper."""
MOMENTS, SLICES = 5, 10
"""Numbers of matrices that are drawn of a clip, one by one and as a volume."""
MIN_DRAWN = 1e-16
"""Smaller changes of lambda are rounding errors."""


def shown_methods(evaluation: RetrievalEvaluation) -> tuple[str, ...]:
    """The methods whose confusion matrix is shown by default: all if there are few."""
    judged_methods = tuple(judged.figures.method for judged in evaluation.methods)
    return (
        tuple(name for name in SIDE_BY_SIDE if name in judged_methods)
        or judged_methods[: len(SIDE_BY_SIDE)]
    )


def confusion_figure(evaluation: RetrievalEvaluation, names: Sequence[str], form: Format) -> bytes:
    """The confusion matrices of these methods side by side."""
    matrices = {
        f"{judged.figures.method}, {evaluation.k} nearest\n"
        f"mean {100 * judged.overall_confusion:.1f} %": judged.confusion
        for judged in evaluation.methods
        if judged.figures.method in names
    }
    return confusions_picture(
        matrices, evaluation.classes, form, columns="retrieved", sizes=evaluation.sizes
    )


def vectors_figure(volumes: VolumeEvaluation, form: Format) -> bytes:
    """Primary vectors above, secondary vectors below; a column for each class, a curve for each
    clip.

    Secondary vectors have length 1, so the values of a clip of T frames are about 1 / sqrt(T). They
    are drawn times sqrt(T), so that clips of any length can be compared.
    """
    joints = [role.value.replace("_", " ") for role in SUN_ROLES]
    joint_indices = np.arange(float(len(joints)))
    all_factors = [one for some in volumes.factors.values() for one in some]
    rho_range = _range([one.primary for one in all_factors])
    epsilon_range = _range([_unscaled(one.secondary) for one in all_factors])
    above = [
        Panel(
            [Curve(joint_indices, one.primary) for one in some],
            title=f"{name} ({len(some)} clips)",
            y_label="primary vector ρ" if first else "",
            ticks=joints,
            y_range=rho_range,
        )
        for first, (name, some) in _columns(volumes)
    ]
    below = [
        Panel(
            [
                Curve(np.arange(len(one.secondary)) / ANALYSIS_RATE, _unscaled(one.secondary))
                for one in some
            ],
            x_label="seconds",
            y_label="secondary vector ε · √T" if first else "",
            y_range=epsilon_range,
        )
        for first, (_, some) in _columns(volumes)
    ]
    title = f"Rank-1 factors of the motion sequence volumes, q = {volumes.q}{_eta(volumes)}"
    return curves_picture([*above, *below], form, title=title, columns=len(volumes.factors))


def matrices_figure(volumes: VolumeEvaluation, form: Format) -> bytes:
    """Self-similarity matrices of one clip of each class at a few moments (figure 3)."""
    joints = [role.value.replace("_", " ") for role in SUN_ROLES]
    title = f"Self-similarity matrices, q = {volumes.q}{_eta(volumes)}"
    label = "distance of joints, body lengths" if not volumes.threshold else "nearer than η"
    return matrices_picture(_slices(volumes, MOMENTS), joints, form, title=title, label=label)


def volumes_figure(volumes: VolumeEvaluation, form: Format) -> bytes:
    """The motion volume of one clip of each class (figure 5)."""
    title = f"Motion sequence volumes, q = {volumes.q}{_eta(volumes)}"
    return volumes_picture(_slices(volumes, SLICES), form, title=title)


def _slices(volumes: VolumeEvaluation, count: int) -> dict[str, Slices]:
    """Slices at `count` moments, evenly over each example."""
    slices = {}
    for name, matrices in volumes.examples.items():
        frames = np.linspace(0, len(matrices) - 1, count).round().astype(np.int64)
        slices[name] = Slices(matrices[frames], frames / ANALYSIS_RATE)
    return slices


def convergence_figure(volumes: VolumeEvaluation, form: Format) -> bytes:
    """The error of the factors and the change of lambda after each iteration."""
    errors = Panel(
        _by_iteration(volumes, lambda one: one.errors),
        title="|A - λ ρ∘ρ∘ε| / |A|",
        x_label="iteration",
        marked=[ENOUGH_ITERATIONS],
    )
    changes = Panel(
        _by_iteration(volumes, lambda one: np.maximum(one.changes, MIN_DRAWN)),
        title="change of λ / λ",
        x_label="iteration",
        marked=[ENOUGH_ITERATIONS],
        log_y=True,
    )
    title = f"Rank-1 decomposition, q = {volumes.q}{_eta(volumes)}"
    return curves_picture([errors, changes], form, title=title)


def _by_iteration(
    volumes: VolumeEvaluation, values_of: Callable[[Rank1], FloatArray]
) -> list[Curve]:
    return [
        Curve(np.arange(1.0, one.iterations + 1), values_of(one), name)
        for name, some in volumes.factors.items()
        for one in some
    ]


def all_figures(
    evaluation: RetrievalEvaluation, volumes: VolumeEvaluation, form: Format
) -> dict[str, bytes]:
    """All pictures by file name, with a confusion matrix for each method."""
    figures = {
        f"confusion-{_file_name(judged.figures.method)}.{form}": confusion_figure(
            evaluation, [judged.figures.method], form
        )
        for judged in evaluation.methods
    }
    figures[f"matrices.{form}"] = matrices_figure(volumes, form)
    figures[f"volumes.{form}"] = volumes_figure(volumes, form)
    figures[f"vectors.{form}"] = vectors_figure(volumes, form)
    figures[f"convergence.{form}"] = convergence_figure(volumes, form)
    return figures


def _columns(volumes: VolumeEvaluation) -> list[tuple[bool, tuple[str, tuple[Rank1, ...]]]]:
    """For each class: whether it is the first column, and its name and factors."""
    return [(index == 0, item) for index, item in enumerate(volumes.factors.items())]


def _unscaled(epsilon: FloatArray) -> FloatArray:
    return np.asarray(epsilon * np.sqrt(len(epsilon)))


def _range(vectors: Sequence[FloatArray]) -> tuple[float, float]:
    """Common limits of all columns of a row, so that the columns can be compared."""
    low, high = (float(pick([pick(v) for v in vectors])) for pick in (np.min, np.max))
    margin = 0.05 * (high - low) or 0.05
    return low - margin, high + margin


def _eta(volumes: VolumeEvaluation) -> str:
    return f", η = {volumes.threshold:g}" if volumes.threshold else ""


def _file_name(method: str) -> str:
    return re.sub(r"[^a-z0-9.-]+", "-", method.replace("=", ""))
