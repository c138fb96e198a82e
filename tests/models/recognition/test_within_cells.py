from __future__ import annotations

import numpy as np
import pytest

from app.models.cells import cell_means, find_cells
from app.models.recognition.within_cells import Scatter, scatter_within


def scattered(
    sizes: dict[tuple[str, str], np.ndarray], takes: int
) -> tuple[Scatter, dict[tuple[str, str], np.ndarray], list[tuple[str, str]]]:
    """Of cells whose takes deviate so much in each dimension: what is found, as the covariance
    of each cell, and the cells in order."""
    rng = np.random.default_rng(0)
    labels = [cell for cell in sizes for _ in range(takes)]
    points = np.array([3.0 + rng.normal(size=len(sizes[cell])) * sizes[cell] for cell in labels])
    cells = find_cells([who for who, _ in labels], [what for _, what in labels])
    deviations = points - cell_means(points, cells)[cells.member]
    pooled = deviations.T @ deviations / (len(points) - len(cells))
    found = scatter_within(deviations, cells.member, cells, pooled)
    order = [
        (cells.persons[p], cells.tasks[t]) for p, t in zip(cells.person, cells.task, strict=True)
    ]
    covariances = {
        cell: found.spread[i] * found.covariances[found.form[i]] for i, cell in enumerate(order)
    }
    return found, covariances, order


def test_many_takes_give_each_task_its_own_covariance() -> None:
    walk, wave = np.array([0.2, 0.2, 2.0]), np.array([1.0, 3.0, 0.3])
    sizes = {(who, what): size for who in "abc" for what, size in (("walk", walk), ("wave", wave))}
    _, covariances, _ = scattered(sizes, takes=300)
    for (_, task), covariance in covariances.items():
        truth = np.diag((walk if task == "walk" else wave) ** 2)
        assert np.linalg.norm(covariance - truth) < 0.12 * np.linalg.norm(truth)


def test_a_person_has_one_factor_for_all_tasks() -> None:
    sizes = {
        (who, what): np.full(5, size * scale)
        for who, scale in (("even", 0.5), ("uneven", 1.5))
        for what, size in (("walk", 0.1), ("wave", 1.0))
    }
    _, covariances, _ = scattered(sizes, takes=200)
    for task in ("walk", "wave"):
        ratio = np.trace(covariances["uneven", task]) / np.trace(covariances["even", task])
        assert ratio == pytest.approx(9.0, rel=0.15)


def test_few_takes_hardly_change_the_pooled_covariance() -> None:
    sizes = {(who, what): np.ones(8) for who in "abcdef" for what in "xyz"}
    found, covariances, order = scattered(sizes, takes=2)
    assert len(found.covariances) == 4
    assert found.spread == pytest.approx(np.ones(len(order)), abs=0.4)
    for covariance in covariances.values():
        assert np.all(np.linalg.eigvalsh(covariance) >= 0)


def test_without_repeated_takes_of_a_task_its_shape_is_the_pooled_one() -> None:
    cells = find_cells(["a", "a", "b", "b", "c"], ["x", "x", "x", "x", "y"])
    deviations = np.array([[1.0, 0], [-1, 0], [0, 1], [0, -1]])
    found = scatter_within(deviations, cells.member[:4], cells, np.eye(2))
    alone = cells.task.tolist().index(1)
    np.testing.assert_array_equal(found.covariances[found.form[alone]], np.eye(2))
    assert found.spread[alone] == 1.0
