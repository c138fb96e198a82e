from __future__ import annotations

import numpy as np

from app.models.cells import find_cells
from app.models.recognition.hypotheses import fit_hypotheses
from app.models.recognition.kinds import Disturbed, Kind
from app.models.recognition.mirrored_cells import mirrored_cells

PERSONS = ["ada", "ada", "ada", "bo", "bo", "bo"]
TASKS = ["kick left", "kick right", "walk", "kick left", "walk", "wave left"]
CELLS = find_cells(PERSONS, TASKS)


def test_a_mirrored_task_has_the_other_side_where_the_library_knows_it() -> None:
    copies = np.arange(6.0)[:, None]
    found = mirrored_cells(copies, PERSONS, TASKS, CELLS)
    assert found is not None
    labels = [
        (CELLS.persons[person], CELLS.tasks[task], mean)
        for mean, person, task in zip(found.means[:, 0], found.person, found.task, strict=True)
    ]
    assert labels == [
        ("ada", "kick left", 1.0),
        ("ada", "kick right", 0.0),
        ("ada", "walk", 2.0),
        ("bo", "kick right", 3.0),
        ("bo", "walk", 4.0),
    ]  # no task is a wave of the right hand


def test_copies_of_one_cell_have_one_mean() -> None:
    found = mirrored_cells(np.array([[1.0], [3.0]]), ["ada", "ada"], ["walk", "walk"], CELLS)
    assert found is not None
    assert found.means.tolist() == [[2.0]]


def test_without_labels_that_allow_it_there_is_none() -> None:
    assert mirrored_cells(np.ones((2, 1)), ["bo", None], ["wave left", "walk"], CELLS) is None


def test_a_mirrored_clip_is_most_likely_a_mirrored_cell() -> None:
    rng = np.random.default_rng(1)
    persons, tasks = zip(
        *[(p, t) for p in "abc" for t in ("left", "right", "walk")] * 3, strict=True
    )
    cells = find_cells(persons, tasks)
    centers = rng.normal(size=(len(cells), 4))
    points = centers[cells.member] + 0.05 * rng.normal(size=(27, 4))
    turned = points + np.array([3.0, 0.0, 0.0, 0.0])
    own = mirrored_cells(turned, persons, tasks, cells)
    fitted = fit_hypotheses(points, cells, mirrored=own)
    best = fitted.log_likelihoods(turned).argmax(axis=1)
    assert (fitted.disturbed[best] == Disturbed.MIRRORED).all()
    assert (fitted.kind[best] == Kind.SEEN).all()
    assert [cells.persons[i] for i in fitted.person[best]] == list(persons)
    side = {"left": "right", "right": "left", "walk": "walk"}
    assert [cells.tasks[i] for i in fitted.task[best]] == [side[task] for task in tasks]
    assert (fitted.disturbed[fitted.log_likelihoods(points).argmax(axis=1)] == Disturbed.NOT).all()
