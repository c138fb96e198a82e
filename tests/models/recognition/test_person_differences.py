from __future__ import annotations

import numpy as np
import pytest

from app.models.cells import cell_means, find_cells
from app.models.recognition.person_differences import label_centers, person_differences


def test_each_task_has_its_size() -> None:
    rng = np.random.default_rng(0)
    scales = {"bow": 0.1, "dance": 2.0, "walk": 0.3}
    who, what = zip(*[(f"p{p}", task) for p in range(60) for task in scales], strict=True)
    points = rng.standard_normal((len(who), 6)) * np.array([scales[task] for task in what])[:, None]
    cells = find_cells(who, what)
    found = person_differences(cell_means(points, cells), cells, np.eye(6))
    for index, task in enumerate(cells.tasks):
        variance = float(np.trace(found.size[index] * found.covariance)) / 6
        assert variance == pytest.approx(2 * scales[task] ** 2, rel=0.35)


def test_one_wild_task_does_not_change_the_others() -> None:
    rng = np.random.default_rng(1)
    who, what = zip(*[(f"p{p}", t) for p in range(10) for t in "abcdef"], strict=True)
    cells = find_cells(who, what)
    calm = rng.standard_normal((len(who), 4))
    wild = np.where(np.array(what)[:, None] == "c", 30 * calm, calm)
    before, after = (
        person_differences(cell_means(points, cells), cells, np.eye(4)) for points in (calm, wild)
    )
    of_a = [float(np.trace(each.size[0] * each.covariance)) for each in (before, after)]
    assert of_a[1] < 3 * of_a[0]  # one covariance for all would be 150 times as large


@pytest.mark.parametrize("tasks", [["x", "y", "z", "x"], [None] * 4])
def test_few_shared_tasks_give_the_fallback(tasks: list[str | None]) -> None:
    cells = find_cells(list("abcd"), tasks)
    found = person_differences(np.eye(4), cells, 3 * np.eye(4))
    np.testing.assert_array_equal(found.covariance, 3 * np.eye(4))
    np.testing.assert_array_equal(found.size, np.ones(len(cells.tasks) + 1))


def test_centers_are_means_of_labels() -> None:
    centers = label_centers(np.array([[1.0], [3.0], [7.0], [9.0]]), np.array([0, 0, 2, -1]), 3)
    np.testing.assert_array_equal(centers, [[2.0], [0.0], [7.0]])
