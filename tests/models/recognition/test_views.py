from __future__ import annotations

import numpy as np
import pytest

from app.models.cells import find_cells
from app.models.recognition.hypotheses import fit_hypotheses
from app.models.recognition.kinds import Disturbed
from app.models.recognition.views import BothViews, LogDensities, newness


@pytest.mark.parametrize("what", [Disturbed.LIGHTLY, Disturbed.CUT])
def test_cut_clips_count_for_the_ranking_but_decide_nothing(what: Disturbed) -> None:
    rng = np.random.default_rng(0)
    who, what_done = ["a", "a", "b", "b", "c", "c"] * 4, ["x", "y"] * 12
    points = rng.standard_normal((24, 3))
    cells = find_cells(who, what_done)
    plain = fit_hypotheses(points, cells)
    disturbed = fit_hypotheses(points, cells, {what: 25 * np.eye(3)})
    far = BothViews(points[:6] + 4, points[:6] + 4)
    logs, more = (LogDensities.under(h, h, far, persons_by_both=True) for h in (plain, disturbed))
    assert (more.ranking.max(axis=1) > logs.ranking.max(axis=1)).all()
    for before, after, label, label_after in (
        (logs.new_person, more.new_person, plain.person, disturbed.person),
        (logs.new_task, more.new_task, plain.task, disturbed.task),
    ):
        same = np.isclose(newness(before, label), newness(after, label_after)).all()
        assert same == (what is Disturbed.CUT)
