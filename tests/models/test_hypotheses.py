from __future__ import annotations

from itertools import permutations

import numpy as np

from app.models.cells import cell_means, find_cells
from app.models.hypotheses import Hypotheses, Kind, fit_hypotheses, shrunk


def of_kind(record: Hypotheses, kind: Kind) -> tuple[np.ndarray, np.ndarray]:
    """Means of the hypotheses of a kind, unwhitened, and their covariance."""
    back = np.linalg.inv(record.whiteners[kind])
    return record.means[record.kind == kind] @ back, back.T @ back


def test_strangers_differ_from_each_person_as_pairs_of_persons_do() -> None:
    rng = np.random.default_rng(0)
    who, what = zip(
        *[(p, t) for p in "abcd" for t in "xyz" if (p, t) != ("d", "z")] * 2, strict=True
    )
    points = rng.standard_normal((len(who), 4))
    cells = find_cells(who, what)
    means = cell_means(points, cells)
    apart = [
        means[i] - means[j]
        for i, j in permutations(range(len(means)), 2)
        if cells.task[i] == cells.task[j]
    ]
    centres, covariance = of_kind(fit_hypotheses(points, cells), Kind.NEW_PERSON)
    np.testing.assert_allclose(centres, means, atol=1e-12)
    np.testing.assert_allclose(covariance, shrunk(np.mean([np.outer(d, d) for d in apart], axis=0)))


def test_a_strangers_task_is_found_where_persons_do_it_in_different_ways() -> None:
    """Half do `x` at -4 and `y` at 2, half do them at 4 and 10: the means say 0 and 6."""
    rng = np.random.default_rng(1)
    persons = [f"p{i}" for i in range(6) for _ in "xy"]
    tasks = ["x", "y"] * 6
    ways = np.repeat([-4.0, 4.0], 6)
    places = ways + np.tile([0.0, 6.0], 6)
    points = np.column_stack([places, np.zeros(12)]) + rng.normal(scale=0.3, size=(12, 2))
    record = fit_hypotheses(points, find_cells(persons, tasks))
    stranger = record.log_likelihoods(np.array([[4.0, 0.0]]))[0]
    of_x, of_y = (
        stranger[(record.kind == Kind.NEW_PERSON) & (record.task == task)].max() for task in (0, 1)
    )
    assert of_x > of_y
