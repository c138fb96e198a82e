from __future__ import annotations

from itertools import pairwise

import numpy as np

from app.models.alignment import BAND, RELUCTANCE, _path, fit_courses, warped
from app.models.multilinear import Multilinear, fit_multilinear, recognise_multilinear
from app.numerics.arrays import FloatArray

MOMENTS = 24


def _curve(times: FloatArray) -> FloatArray:
    """(moments, 3) a motion that comes back to no place of its own."""
    return np.stack([np.sin(5 * times), np.cos(3 * times), times], axis=-1)


def _hurried(by: float) -> FloatArray:
    """The curve, its middle `by` late."""
    times = np.linspace(0, 1, MOMENTS)
    return _curve(times + by * np.sin(np.pi * times))


def test_the_path_is_the_cheapest_of_all() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        cost = rng.random((6, 6))
        path = _path(cost.tolist(), 0.3)
        held = sum(a[0] == b[0] or a[1] == b[1] for a, b in pairwise(path))
        found = sum(cost[cell] for cell in path) + 0.3 * held
        assert np.isclose(found, _slow(cost, 0.3, 5, 5))


def _slow(cost: FloatArray, reluctance: float, i: int, j: int) -> float:
    if abs(i - j) > max(1, int(BAND * len(cost))) or min(i, j) < 0:
        return np.inf
    if (i, j) == (0, 0):
        return float(cost[0, 0])
    ways = (
        _slow(cost, reluctance, i - 1, j - 1),
        _slow(cost, reluctance, i - 1, j) + reluctance,
        _slow(cost, reluctance, i, j - 1) + reluctance,
    )
    return float(cost[i, j]) + min(ways)


def test_a_motion_in_another_time_falls_onto_the_reference() -> None:
    reference, late = _hurried(0.0), _hurried(-0.15)
    before = np.abs(late - reference).mean()
    after = np.abs(warped(late[None], reference)[0] - reference).mean()
    assert after < 0.35 * before
    np.testing.assert_allclose(warped(reference[None], reference)[0], reference)
    assert 0 < RELUCTANCE < 1


def test_takes_of_a_task_get_one_course_and_other_tasks_keep_theirs() -> None:
    rng = np.random.default_rng(1)
    motions = np.stack([_hurried(by) for by in rng.uniform(-0.15, 0.15, 12)])
    tasks = ["wave"] * 6 + ["bow"] * 5 + [None]
    motions[6:] += 3.0
    courses = fit_courses(motions, tasks)
    assert courses.tasks == ("bow", "wave")
    aligned = courses.aligned(motions, tasks)
    for own in (slice(0, 6), slice(6, 11)):
        assert aligned[own].std(axis=0).mean() < 0.5 * motions[own].std(axis=0).mean()
    np.testing.assert_array_equal(aligned[11], motions[11])


def test_persons_are_told_apart_whatever_their_timing() -> None:
    samples, persons, tasks = _clips(np.random.default_rng(2))
    train = np.arange(len(samples)) % 4 > 0
    who, what = ([names[i] for i in np.flatnonzero(train)] for names in (persons, tasks))
    model = fit_multilinear(samples[train], who, what, moments=MOMENTS)
    arrays, meta = model.to_arrays()
    again = Multilinear.from_arrays(arrays, meta)
    hits = []
    for i in np.flatnonzero(~train):
        for known in (None, tasks[i]):
            found = recognise_multilinear(again, samples[i], known_task=known)
            assert found == recognise_multilinear(model, samples[i], known_task=known)
            hits.append(found.person.candidates[0].label == persons[i])
    assert np.mean(hits) > 0.9


def _clips(rng: np.random.Generator) -> tuple[FloatArray, list[str], list[str]]:
    """Three persons, each with a bearing of their own, two tasks, eight takes, all in their own
    time; after the poses two numbers that no warping may touch."""
    bearings = 0.15 * rng.normal(size=(3, 3))
    cells = [(p, t) for p in range(3) for t in range(2) for _ in range(8)]
    poses = [_hurried(rng.uniform(-0.15, 0.15)) * (1 - 2 * t) + bearings[p] for p, t in cells]
    tail = np.array([[float(t), 1.0] for _, t in cells])
    flat = np.stack([pose.ravel() for pose in poses])
    return np.hstack([flat, tail]), [f"p{p}" for p, _ in cells], [f"t{t}" for _, t in cells]
