from __future__ import annotations

import numpy as np
import pytest

from app.models.held_out.synthesis import (
    NEW_PERSON,
    NEW_TASK,
    Trial,
    draw_trials,
    held_out_synthesis,
    real_hit,
    synthesized,
)
from app.models.synthesis.model import fit_synthesis
from tests.models.invented_shapes import invented_shapes


def test_whole_cells_are_left_out_and_compared_with_the_baselines() -> None:
    clips = invented_shapes()
    record = fit_synthesis(clips.shapes, clips.persons, clips.tasks)
    found = held_out_synthesis(record, trials=10)
    assert [row["given"] for row in found[NEW_TASK]] == [1, 2, 3]
    assert [row["given"] for row in found[NEW_PERSON]] == [1, 2, 3, 5]
    assert all(row["trials"] == 10 for rows in found.values() for row in rows)
    assert found[NEW_TASK][-1]["hit"] >= 0.8 > found[NEW_TASK][-1]["task_mean"]
    assert found[NEW_PERSON][-1]["hit"] >= found[NEW_PERSON][0]["hit"]
    assert all(row["real"] == 1.0 for rows in found.values() for row in rows)
    assert found == held_out_synthesis(record, trials=10)


def test_followed_and_averaged_cells_are_counted_separately() -> None:
    clips = invented_shapes()
    shapes = clips.shapes.copy()
    alone = np.array([task == "t0" for task in clips.tasks])
    rng = np.random.default_rng(3)  # to each t0 is something else
    shapes[alone, :-2] = 3 * rng.normal(size=(alone.sum(), shapes.shape[1] - 2))
    record = fit_synthesis(shapes, clips.persons, clips.tasks)
    for row in held_out_synthesis(record, trials=100)[NEW_TASK]:
        drawn = draw_trials(record, NEW_TASK, row["given"], 100)
        follows = [synthesized(record, NEW_TASK, trial).follows is not None for trial in drawn]
        assert all(f for trial, f in zip(drawn, follows, strict=True) if trial.task == "t0")
        followed, averaged = row["followed"], row["averaged"]
        assert (followed["trials"], averaged["trials"]) == (sum(follows), len(drawn) - sum(follows))
        hits = sum(part["hit"] * part["trials"] for part in (followed, averaged))
        assert hits / row["trials"] == pytest.approx(row["hit"], abs=1e-3)
        assert followed["hit"] < averaged["hit"]


def test_real_takes_of_cells_with_two_takes_are_judged_too() -> None:
    clips = invented_shapes()
    mixed = clips.shapes.copy()
    mixed[0], mixed[2] = clips.shapes[2], clips.shapes[0]  # a take of t0 for one of t1
    record = fit_synthesis(mixed, clips.persons, clips.tasks)
    cells = [Trial("p0", "t0", ()), Trial("p0", "t1", ()), Trial("p1", "t0", ())]
    assert real_hit(record, cells) == pytest.approx(2 / 6, abs=1e-4)
    once = fit_synthesis(clips.shapes[::2], clips.persons[::2], clips.tasks[::2])
    assert real_hit(once, cells) is None


@pytest.mark.parametrize("kind", [NEW_TASK, NEW_PERSON])
@pytest.mark.parametrize("lacking", [[], [("p1", "t1"), ("p2", "t3"), ("p3", "t0")]])
def test_a_trial_does_not_see_its_own_cell(kind: str, lacking: list[tuple[str, str]]) -> None:
    clips = invented_shapes()
    for cell in lacking:
        clips = clips.without(*cell)
    record = fit_synthesis(clips.shapes, clips.persons, clips.tasks)
    for trial in draw_trials(record, kind, 2, 8):
        mine = [
            label == (trial.person, trial.task)
            for label in zip(clips.persons, clips.tasks, strict=True)
        ]
        changed = np.array(clips.shapes)
        changed[mine] += 5.0
        other = fit_synthesis(changed, clips.persons, clips.tasks)
        np.testing.assert_array_equal(
            synthesized(record, kind, trial).shape, synthesized(other, kind, trial).shape
        )


def test_a_library_with_no_cell_to_leave_out_has_no_rows() -> None:
    shapes = invented_shapes(persons=3, tasks=1, takes=1).shapes
    record = fit_synthesis(shapes, ["p0", "p1", "p2"], ["t0", "t0", "t1"])
    assert held_out_synthesis(record) == {NEW_TASK: [], NEW_PERSON: []}
