from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.held_out.ranking import mean_average_precision
from app.models.metric.learned_metric import (
    COORDINATES,
    ClipDescriptors,
    Factor,
    LearnedMetric,
    MetricAxes,
    fit_axes,
)
from app.models.metric.pair_calibration import PairCalibration
from tests.models.factor_clips import FactorClips, factor_clips

WIDTHS = (12, 40, 8)


def described(clips: FactorClips) -> ClipDescriptors:
    """The samples of invented clips, taken apart into three descriptors of unlike units."""
    vectors, samples, statistics = np.split(clips.samples, np.cumsum(WIDTHS)[:-1], axis=1)
    return ClipDescriptors(vectors, 7 * samples, statistics[:, ::-1] * np.geomspace(0.01, 30, 8))


def share_found(axes: MetricAxes, clips: FactorClips, labels: list[str], asks: np.ndarray) -> float:
    """MAP of the clips `asks`, each asking all others for its label."""
    points = axes.project(described(clips))
    scores = points[asks] @ points.T
    relevant = np.array(labels)[asks][:, None] == np.array(labels)
    rows = np.arange(len(asks))
    scores[rows, asks] = np.inf  # the query itself stands first, and is taken out
    order = np.argsort(-scores, axis=1, kind="stable")[:, 1:]
    found = np.take_along_axis(relevant, order, axis=1)
    return mean_average_precision(-np.tile(np.arange(found.shape[1]), (len(asks), 1)), found)


@pytest.mark.parametrize("factor", list(Factor))
def test_a_metric_brings_unseen_clips_of_one_label_together(factor: Factor) -> None:
    clips = factor_clips(noise=1.5 if factor is Factor.TASK else 0.6)
    labels = clips.tasks if factor is Factor.TASK else clips.persons
    unseen = np.flatnonzero(clips.takes == 0)
    known = [None if take == 0 else name for take, name in zip(clips.takes, labels, strict=True)]
    learned = share_found(fit_axes(described(clips), known, factor), clips, labels, unseen)
    nothing = MetricAxes(described(clips).concatenated().mean(axis=0), np.eye(sum(WIDTHS)))
    assert learned > share_found(nothing, clips, labels, unseen) + 0.15
    assert learned > 0.85


def test_more_labels_improve_a_metric_and_two_for_each_class_help() -> None:
    clips = factor_clips(persons=6, takes=5, noise=2.0)
    unseen = np.flatnonzero(clips.takes == 0)
    shares = []
    for persons in (2, 3, 6):
        known = [
            task if take > 0 and int(who[1:]) < persons else None
            for take, who, task in zip(clips.takes, clips.persons, clips.tasks, strict=True)
        ]
        axes = fit_axes(described(clips), known, Factor.TASK)
        shares.append(share_found(axes, clips, clips.tasks, unseen))
    assert shares == sorted(shares)
    nothing = MetricAxes(described(clips).concatenated().mean(axis=0), np.eye(sum(WIDTHS)))
    assert shares[0] > share_found(nothing, clips, clips.tasks, unseen) + 0.1


def test_a_task_without_labels_is_separated_from_others() -> None:
    clips = factor_clips(tasks=8)
    new = np.array([task in ("t6", "t7") for task in clips.tasks])
    known = [None if is_new else task for is_new, task in zip(new, clips.tasks, strict=True)]
    axes = fit_axes(described(clips), known, Factor.TASK)
    assert share_found(axes, clips, clips.tasks, np.flatnonzero(new)) > 0.9


def test_coordinates_are_of_unit_length_and_few() -> None:
    clips = factor_clips()
    points = fit_axes(described(clips), clips.tasks, Factor.TASK).project(described(clips))
    assert points.shape[1] <= COORDINATES
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1)


def test_the_units_of_the_descriptors_do_not_matter() -> None:
    clips = factor_clips()
    plain = described(clips)
    scaled = ClipDescriptors(100 * plain.vectors, 0.01 * plain.samples, plain.statistics)
    ours = fit_axes(plain, clips.tasks, Factor.TASK).project(plain)
    theirs = fit_axes(scaled, clips.tasks, Factor.TASK).project(scaled)
    np.testing.assert_allclose(ours @ ours.T, theirs @ theirs.T, atol=1e-6)


@pytest.mark.parametrize(
    "labels", [[], [None, None, None], ["a", "a", None], ["a", "a", "b"], ["a", "b", "c"]]
)
def test_too_few_labels_are_refused_with_their_number(labels: list[str | None]) -> None:
    empty = np.zeros((len(labels), 3))
    with pytest.raises(NotEnoughLabels, match=r"2 tasks with two clips each"):
        fit_axes(ClipDescriptors(empty, empty, empty), labels, Factor.TASK)


@pytest.mark.parametrize("spread", [0.0, 1.0])
def test_small_libraries_and_motionless_clips_give_finite_coordinates(spread: float) -> None:
    columns = np.outer(spread * np.arange(4.0), np.ones(3)) + 1
    clips = ClipDescriptors(columns, columns, columns)
    axes = fit_axes(clips, ["a", "a", "b", "b"], Factor.PERSON)
    far = np.full((1, 3), 1e6)
    for probe in (clips, ClipDescriptors(far, far, far)):
        assert np.isfinite(axes.project(probe)).all()


def test_a_record_comes_back_from_its_arrays() -> None:
    clips = factor_clips()
    axes = fit_axes(described(clips), clips.tasks, Factor.TASK)
    record = LearnedMetric(axes, PairCalibration(2.0, 5.0))
    arrays, meta = record.to_arrays()
    again = LearnedMetric.from_arrays(arrays, json.loads(json.dumps(meta)))
    assert again.calibration == record.calibration
    ours, theirs = (r.axes.project(described(clips)) for r in (record, again))
    np.testing.assert_allclose(ours, theirs, atol=1e-5)
    with pytest.raises(ValueError, match="version"):
        LearnedMetric.from_arrays(arrays, meta | {"version": 0})


def test_fitting_twice_gives_the_same() -> None:
    clips = factor_clips()
    one, other = (fit_axes(described(clips), clips.tasks, Factor.TASK) for _ in range(2))
    np.testing.assert_array_equal(one.axes, other.axes)
