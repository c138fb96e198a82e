from __future__ import annotations

import numpy as np

from app.models.recognition.multilinear import Multilinear, fit_multilinear, recognize_multilinear
from app.models.recognition.task_means import fit_task_means
from app.numerics.arrays import FloatArray

MOMENTS = 24


def _curve(times: FloatArray) -> FloatArray:
    """(moments, 3) a motion that never comes back to a position."""
    return np.stack([np.sin(5 * times), np.cos(3 * times), times], axis=-1)


def _hurried(by: float) -> FloatArray:
    """The curve, its middle `by` late."""
    times = np.linspace(0, 1, MOMENTS)
    return _curve(times + by * np.sin(np.pi * times))


def test_takes_of_a_task_are_warped_together_and_other_tasks_apart() -> None:
    rng = np.random.default_rng(1)
    motions = np.stack([_hurried(by) for by in rng.uniform(-0.15, 0.15, 12)])
    tasks = ["wave"] * 6 + ["bow"] * 5 + [None]
    motions[6:] += 3.0
    means = fit_task_means(motions, tasks)
    assert means.tasks == ("bow", "wave")
    aligned = means.aligned(motions, tasks)
    for own in (slice(0, 6), slice(6, 11)):
        assert aligned[own].std(axis=0).mean() < 0.5 * motions[own].std(axis=0).mean()
    np.testing.assert_array_equal(aligned[11], motions[11])
    np.testing.assert_array_equal(means.onto(motions[:6], "wave"), aligned[:6])


def test_without_tasks_nothing_is_warped() -> None:
    motions = np.stack([_hurried(0.0), _hurried(0.1)])
    means = fit_task_means(motions, [None, None])
    assert means.tasks == ()
    np.testing.assert_array_equal(means.aligned(motions, [None, "wave"]), motions)


def test_persons_are_recognized_with_any_timing() -> None:
    samples, persons, tasks = _clips(np.random.default_rng(2))
    train = np.arange(len(samples)) % 4 > 0
    who, what = ([names[i] for i in np.flatnonzero(train)] for names in (persons, tasks))
    model = fit_multilinear(samples[train], who, what, moments=MOMENTS)
    arrays, meta = model.to_arrays()
    again = Multilinear.from_arrays(arrays, meta)
    hits = []
    for i in np.flatnonzero(~train):
        for known in (None, tasks[i]):
            found = recognize_multilinear(again, samples[i], known_task=known)
            assert found == recognize_multilinear(model, samples[i], known_task=known)
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
