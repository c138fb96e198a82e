from __future__ import annotations

import numpy as np

from app.models.cells import find_cells
from app.models.recognition.hypotheses import fit_hypotheses
from app.models.recognition.reach import (
    LEAST,
    SHARE,
    allowance,
    nearest_cells,
    reach_of,
    recorded_cells,
)
from app.models.recognition.views import BothViews, LogDensities, newness


def test_the_reach_is_the_novelty_of_a_clip_at_the_mean_of_the_cell() -> None:
    rng = np.random.default_rng(0)
    who = [person for person in "abcd" for _ in range(9)]
    what = ["x", "y", "z"] * 12
    points = rng.normal(size=(36, 3)) + 4 * np.array(
        [["xyz".index(t), 0, ord(p)] for p, t in zip(who, what, strict=True)]
    )
    cells = find_cells(who, what)
    views = fit_hypotheses(points, cells), fit_hypotheses(points[:, :2], cells)
    asked = recorded_cells(views[1])
    reach = reach_of(views, np.append(asked, -1), persons_by_both=True)
    assert reach.person[-1] == reach.task[-1] == -np.inf
    for index, cell in enumerate(asked):
        named = [
            i
            for i in range(36)
            if (who[i], what[i]) == ("abcd"[views[1].person[cell]], "xyz"[views[1].task[cell]])
        ]
        mean = points[named].mean(axis=0, keepdims=True)
        at_mean = BothViews(mean, mean[:, :2])
        logs = LogDensities.under(*views, at_mean, persons_by_both=True)
        np.testing.assert_allclose(reach.person[index], newness(logs.new_person, views[1].person))
        np.testing.assert_allclose(reach.task[index], newness(logs.new_task, views[1].task))
        assert nearest_cells(logs.ranking, views[1]).tolist() == [cell]


def test_a_library_without_cells_has_no_nearest_one() -> None:
    points = np.random.default_rng(1).normal(size=(6, 2))
    record = fit_hypotheses(points, find_cells(list("aabbcc"), [None] * 6))
    assert nearest_cells(np.zeros((2, len(record.kind))), record).tolist() == [-1, -1]
    assert not allowance(-30.0, np.array([-np.inf])).any()


def test_a_cell_that_reaches_less_allows_more_up_to_a_limit() -> None:
    reach = np.array([-100.0, -30.0, -20.0, -5.0, 8.0])
    np.testing.assert_allclose(
        -27.0 + allowance(-27.0, reach), [-27.0, SHARE * -30, SHARE * -20, -LEAST, -LEAST]
    )
    assert not allowance(1.0, reach).any()
