from __future__ import annotations

import numpy as np

from app.models.cells import cell_means, even_cells, even_takes, find_cells, fit_effects
from tests.models.factor_clips import factor_clips


def test_takes_of_one_person_at_one_task_share_a_cell() -> None:
    cells = find_cells(["b", "a", "b"], ["run", "run", "run"])
    assert cells.persons == ("a", "b")
    assert cells.tasks == ("run",)
    np.testing.assert_array_equal(cells.member, [1, 0, 1])
    np.testing.assert_array_equal(cells.takes, [1, 2])


def test_a_clip_with_one_label_has_its_own_cell_and_without_labels_none() -> None:
    cells = find_cells(["a", None, "", None, "a"], ["run", "run", "run", None, None])
    assert len(cells) == 4
    assert cells.member[1] != cells.member[2]
    assert cells.member[3] == -1
    np.testing.assert_array_equal(cells.full, [False, False, False, True])


def test_no_labels_at_all_are_no_cells() -> None:
    cells = find_cells([None], [None])
    assert len(cells) == 0
    assert cell_means(np.ones((1, 3)), cells).shape == (0, 3)


def test_means_are_those_of_each_cell_alone() -> None:
    clips = factor_clips()
    tasks = [None if row == 1 else task for row, task in enumerate(clips.tasks)]
    cells = find_cells(clips.persons, tasks)
    means = cell_means(clips.samples, cells)
    for cell in range(len(cells)):
        own = clips.samples[cells.member == cell].mean(axis=0)
        np.testing.assert_allclose(means[cell], own)


def test_a_large_cell_gives_some_takes_and_a_small_one_all() -> None:
    cells = find_cells(["a"] * 100 + ["b"] * 3, ["run"] * 103)
    chosen = even_takes(cells, 13)
    assert len(chosen) == 13
    assert set(chosen[-3:]) == {100, 101, 102}
    assert chosen[0] == 0  # and the others are spread over all takes of the large cell
    assert chosen[9] == 99


def test_each_cell_keeps_a_take_and_a_small_library_all() -> None:
    persons: list[str | None] = ["a", "a", "b", None, "c", "c"]
    tasks = ["run"] * 6
    assert even_cells(persons, tasks, 1) == [0, 2, 4]
    assert even_cells(persons, tasks, 5) == [0, 1, 2, 4, 5]


def test_a_missing_cell_is_predicted_by_the_sum_of_effects() -> None:
    clips = factor_clips(noise=0.0)
    missing = np.array([p == "p1" and t == "t2" for p, t in clips.labels])
    samples, who, what = clips.where(~missing)
    cells = find_cells(who, what)
    effects = fit_effects(cell_means(samples, cells), cells)
    predicted = effects.predict(np.array([1]), np.array([2]))[0]
    truth = clips.samples[missing].mean(axis=0)
    task_mean = samples[[t == "t2" for t in what]].mean(axis=0)
    assert np.linalg.norm(predicted - truth) < 0.8 * np.linalg.norm(task_mean - truth)


def test_errors_are_those_of_leaving_each_cell_out() -> None:
    clips = factor_clips(persons=3, tasks=3, takes=1)
    cells = find_cells(clips.persons, clips.tasks)
    means = cell_means(clips.samples, cells)
    fast = fit_effects(means, cells).errors
    for left_out in range(len(cells)):
        keep = np.arange(len(cells)) != left_out
        samples, who, what = clips.where(keep)
        some = find_cells(who, what)
        effects = fit_effects(cell_means(samples, some), some)
        guess = effects.predict(cells.person[[left_out]], cells.task[[left_out]])[0]
        np.testing.assert_allclose(fast[left_out], means[left_out] - guess, atol=1e-8)
