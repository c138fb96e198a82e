from __future__ import annotations

import numpy as np

from app.models.synthesis import fit_synthesis
from app.models.synthesis_figures import NEW_PERSON, NEW_TASK, draw_trials, held_out_synthesis, made
from tests.models.invented_shapes import invented_shapes


def test_cells_are_left_out_wholly_and_judged_beside_the_baselines() -> None:
    clips = invented_shapes()
    record = fit_synthesis(clips.shapes, clips.persons, clips.tasks)
    found = held_out_synthesis(record, trials=10)
    assert [row["given"] for row in found[NEW_TASK]] == [1, 2, 3]
    assert [row["given"] for row in found[NEW_PERSON]] == [1, 2, 3, 5]
    assert all(row["trials"] == 10 for rows in found.values() for row in rows)
    assert found[NEW_TASK][-1]["hit"] >= 0.8 > found[NEW_TASK][-1]["task_mean"]
    assert found[NEW_PERSON][-1]["hit"] >= found[NEW_PERSON][0]["hit"]
    assert found == held_out_synthesis(record, trials=10)


def test_a_trial_does_not_see_its_own_cell() -> None:
    clips = invented_shapes()
    other = invented_shapes()
    for kind in (NEW_TASK, NEW_PERSON):
        record = fit_synthesis(clips.shapes, clips.persons, clips.tasks)
        trial = draw_trials(record, kind, 2, 1)[0]
        mine = [
            label == (trial.person, trial.task)
            for label in zip(clips.persons, clips.tasks, strict=True)
        ]
        other.shapes[mine] += 5.0
        changed = fit_synthesis(other.shapes, other.persons, other.tasks)
        np.testing.assert_array_equal(made(record, kind, trial), made(changed, kind, trial))
        other = invented_shapes()


def test_a_library_without_anything_to_leave_out_has_no_rows() -> None:
    shapes = invented_shapes(persons=3, tasks=1, takes=1).shapes
    record = fit_synthesis(shapes, ["p0", "p1", "p2"], ["t0", "t0", "t1"])
    assert held_out_synthesis(record) == {NEW_TASK: [], NEW_PERSON: []}
