from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal, multivariate_t

from app.models.cells import cell_means, find_cells
from app.models.recognition.hypotheses import TAKES_FREEDOM, Hypotheses, fit_hypotheses
from app.models.recognition.kinds import Disturbed, Kind


def of_kind(record: Hypotheses, kind: Kind) -> tuple[np.ndarray, np.ndarray]:
    """Means of the hypotheses of a kind, unwhitened, and the covariance of the last of them."""
    chosen = np.flatnonzero(record.kind == kind)
    backs = np.linalg.inv(record.whiteners)[record.form[chosen]]
    means = np.einsum("hd,hde->he", record.means[chosen], backs)
    return means, backs[-1].T @ backs[-1]


def test_new_persons_differ_from_each_person_as_two_persons_do() -> None:
    rng = np.random.default_rng(0)
    who, what = zip(*[(p, t) for p in range(40) for t in ("calm", "wild")], strict=True)
    points = rng.standard_normal((len(who), 3)) * np.tile([[0.2], [1.0]], (40, 1))
    cells = find_cells([f"p{p}" for p in who], what)
    record = fit_hypotheses(points, cells)
    new = np.flatnonzero(record.kind == Kind.NEW_PERSON)
    centers, covariance = of_kind(record, Kind.NEW_PERSON)
    np.testing.assert_allclose(centers, cell_means(points, cells), atol=1e-12)
    for task, variance in (("calm", 0.04), ("wild", 1.0)):
        spread = record.spread[new[cells.task == cells.tasks.index(task)]]
        assert np.ptp(spread) == 0
        found = spread[0] * covariance
        assert np.linalg.norm(found - 2 * variance * np.eye(3)) < variance


def test_the_widest_hypothesis_is_that_person_and_task_are_new() -> None:
    """However far a motion is from all others, it is not that of a known person."""
    rng = np.random.default_rng(6)
    who, what = zip(*[(p, t) for p in "abcdef" for t in "uvwxyz"] * 2, strict=True)
    points = (
        rng.standard_normal((len(who), 3)) + 3 * np.array([ord(t) - 120 for t in what])[:, None]
    )
    record = fit_hypotheses(points, find_cells(who, what))
    for direction in np.vstack([np.eye(3), -np.eye(3), np.ones((1, 3))]):
        logs = record.log_likelihoods(100 * direction[None])[0]
        assert record.kind[logs.argmax()] == Kind.NEW_BOTH


def test_repeated_dances_do_not_make_other_takes_wide() -> None:
    """Only one task is repeated, and its takes differ more than its persons do."""
    rng = np.random.default_rng(7)
    places, ways = 4.0 * rng.standard_normal((12, 5)), 0.5 * rng.standard_normal((8, 5))
    persons, tasks, points = [], [], []
    for person, way in enumerate(ways):
        for task, place in enumerate(places):
            takes = 3 if task == 0 else 1
            persons += [f"p{person}"] * takes
            tasks += [f"t{task:02}"] * takes
            points += list(
                place + way + (3.0 if task == 0 else 0.1) * rng.standard_normal((takes, 5))
            )
    record = fit_hypotheses(np.array(points), find_cells(persons, tasks))
    seen, new = (
        record.spread[h] * np.linalg.norm(np.linalg.inv(record.whiteners[record.form[h]])) ** 2
        for h in (
            np.flatnonzero((record.task == 1) & (record.kind == kind))[0]
            for kind in (Kind.SEEN, Kind.NEW_PERSON)
        )
    )
    assert seen < new / 2


def test_the_task_of_a_new_person_is_recognized_if_persons_do_it_differently() -> None:
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


def test_densities_are_scipys() -> None:
    rng = np.random.default_rng(2)
    who, what = ["a", "a", "b", "b"] * 4, ["x", "y"] * 8
    points = rng.standard_normal((16, 3)) + np.array([[what[i] == "y"] * 3 for i in range(16)])
    record = fit_hypotheses(points, find_cells(who, what))
    probes = 2 * rng.standard_normal((5, 3))
    gaussian, students = record.log_likelihoods(probes), record.log_likelihoods(probes, 7.0)
    for h, form in enumerate(record.form):
        back = np.linalg.inv(record.whiteners[form])
        mean, shape = record.means[h] @ back, record.spread[h] * back.T @ back
        exact = multivariate_normal(mean, shape).logpdf(probes)
        np.testing.assert_allclose(np.diff(gaussian[:, h]), np.diff(exact), atol=1e-9)
        exact = multivariate_t(mean, shape, df=7.0).logpdf(probes)
        np.testing.assert_allclose(np.diff(students[:, h]), np.diff(exact), atol=1e-9)
        both = [multivariate_normal(mean, shape).logpdf(mean) - gaussian_at(record, h, mean)]
        assert both[0] == pytest.approx(multivariate_normal(np.zeros(3)).logpdf(np.zeros(3)))


def gaussian_at(record: Hypotheses, hypothesis: int, point: np.ndarray) -> float:
    return float(record.log_likelihoods(point[None])[0, hypothesis])


def test_each_task_has_its_own_variation_of_takes() -> None:
    rng = np.random.default_rng(3)
    persons, tasks, points = [], [], []
    for person in "abcd":
        for task, size in (("walk", 0.1), ("wave", 1.0)):
            place = rng.normal(scale=5, size=6)
            persons += [person] * 4
            tasks += [task] * 4
            points += list(place + rng.normal(scale=size, size=(4, 6)))
    record = fit_hypotheses(np.array(points), find_cells(persons, tasks))
    own = record.kind == Kind.SEEN
    walk, wave = (np.flatnonzero(own & (record.task == task))[0] for task in (0, 1))
    back = np.linalg.inv(record.whiteners)
    off = {
        name: gaussian_at(record, h, record.means[h] @ back[record.form[h]] + 0.8)
        - gaussian_at(record, h, record.means[h] @ back[record.form[h]])
        for name, h in (("walk", walk), ("wave", wave))
    }
    assert off["walk"] < 3 * off["wave"] < 0


def test_further_takes_have_the_covariance_of_their_cells() -> None:
    rng = np.random.default_rng(4)
    persons, tasks = [p for p in "abc" for _ in range(40)], ["x", "y"] * 60
    points = rng.normal(size=(120, 3)) * [0.1, 1.0, 0.5] + np.arange(120)[:, None] // 40
    record = fit_hypotheses(points, find_cells(persons, tasks))
    takes = record.further_takes(3000, max_cells=100).reshape(6, 3000, 3)
    seen = np.flatnonzero(record.kind == Kind.SEEN)
    for h, drawn in zip(seen, takes, strict=True):
        back = np.linalg.inv(record.whiteners[record.form[h]])
        # the covariance of Student's t
        truth = TAKES_FREEDOM / (TAKES_FREEDOM - 2) * record.spread[h] * back.T @ back
        np.testing.assert_allclose(drawn.mean(axis=0), record.means[h] @ back, atol=0.1)
        assert np.linalg.norm(np.cov(drawn.T) - truth) < 0.1 * np.linalg.norm(truth)
    np.testing.assert_array_equal(takes[:1], record.further_takes(3000, 1).reshape(1, 3000, 3))
    nothing = fit_hypotheses(points, find_cells(persons, [None] * 120))
    assert nothing.further_takes(3, 100).shape == (0, 3)


def test_disturbed_clips_have_hypotheses_of_their_own() -> None:
    rng = np.random.default_rng(4)
    who, what = ["a", "a", "b", "b"] * 5, ["x", "y"] * 10
    points = rng.standard_normal((20, 3))
    cells = find_cells(who, what)
    plain = fit_hypotheses(points, cells)
    moments = {Disturbed.LIGHTLY: 4 * np.eye(3), Disturbed.CUT: 9 * np.eye(3)}
    record = fit_hypotheses(points, cells, moments)
    probes = 2 * rng.standard_normal((5, 3))
    np.testing.assert_array_equal(
        record.log_likelihoods(probes)[:, record.disturbed == Disturbed.NOT],
        plain.log_likelihoods(probes),
    )
    for what_happened, added in moments.items():
        own = record.disturbed == what_happened
        assert record.kind[own].tolist() == plain.kind.tolist()
        np.testing.assert_array_equal(record.task[own], plain.task)
        wide, narrow = (
            of_kind(replace_kinds(record, chosen), Kind.NEW_BOTH)[1]
            for chosen in (own, record.disturbed == Disturbed.NOT)
        )
        np.testing.assert_allclose(wide, narrow + added)


def replace_kinds(record: Hypotheses, chosen: np.ndarray) -> Hypotheses:
    """The record in which only the chosen hypotheses have a kind."""
    return replace(record, kind=np.where(chosen, record.kind, -1))
