from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.held_out.metric import MetricEvaluation, calibration_error, held_out_metric
from app.models.metric.learned_metric import ClipDescriptors, Factor
from app.models.metric.pair_calibration import PairCalibration
from tests.models.factor_clips import FactorClips, factor_clips
from tests.models.metric.test_learned_metric import described


def judge(
    clips: FactorClips,
    factor: Factor,
    tasks: list[str] | None = None,
    groups: list[str] | None = None,
) -> MetricEvaluation:
    together = groups or [str(i) for i in range(len(clips.persons))]
    return held_out_metric(described(clips), clips.persons, tasks or clips.tasks, together, factor)


@pytest.mark.parametrize("factor", list(Factor))
def test_held_out_clips_are_ranked_better_than_by_motion_vectors(factor: Factor) -> None:
    found = judge(factor_clips(noise=1.0 if factor is Factor.TASK else 0.6), factor)
    for held in ("clips_held_out", "tasks_held_out", "persons_held_out"):
        shares = found.figures[held]
        assert shares["queries"] == 120
        assert all(0 <= shares[name] <= 1 for name in shares if name != "queries")
    clips = found.figures["clips_held_out"]
    assert clips["mean_average_precision"] > clips["motion_vector_map"] + 0.2
    assert clips["mean_average_precision"] > 0.9
    assert found.figures["calibration_error"] < 0.05
    json.dumps(found.figures)


def test_random_labels_are_ranked_no_better_than_chance() -> None:
    clips = factor_clips(persons=6, tasks=5, takes=4)
    senseless = np.random.default_rng(0).permutation(clips.tasks).tolist()
    found = judge(clips, Factor.TASK, senseless).figures["clips_held_out"]
    assert found["mean_average_precision"] < 0.3
    assert found["nearest"] < 0.4


def test_a_copy_of_a_recording_is_not_used_to_judge_the_other() -> None:
    clips = factor_clips(persons=6, tasks=5, takes=1)
    senseless = np.random.default_rng(0).permutation(clips.tasks)
    twice = FactorClips(
        np.repeat(clips.samples, 2, axis=0),
        np.repeat(clips.persons, 2).tolist(),
        np.repeat(senseless, 2).tolist(),
        np.repeat(clips.takes, 2),
    )
    together = [str(i // 2) for i in range(len(twice.persons))]
    apart = judge(twice, Factor.TASK).figures["clips_held_out"]
    honest = judge(twice, Factor.TASK, groups=together).figures["clips_held_out"]
    assert apart["nearest"] == 1.0
    assert honest["nearest"] < 0.5


def test_clips_of_each_label_are_counted() -> None:
    clips = factor_clips(persons=3, tasks=3, takes=2)
    tasks = ["rare" if i == 0 else task for i, task in enumerate(clips.tasks)]
    found = judge(clips, Factor.TASK, tasks).figures["labels"]
    assert found == {
        "count": 4,
        "clips": 18,
        "fewest_clips": 1,
        "most_clips": 6,
        "clips_of": {"rare": 1, "t0": 5, "t1": 6, "t2": 6},
    }


def test_a_library_with_two_labels_is_judged_by_clips_alone() -> None:
    clips = factor_clips(persons=1, tasks=2, takes=4)
    found = judge(clips, Factor.TASK)
    assert "clips_held_out" in found.figures
    assert "tasks_held_out" not in found.figures
    assert "persons_held_out" not in found.figures


def test_too_few_labels_are_refused() -> None:
    clips = factor_clips(persons=1, tasks=3, takes=2)
    with pytest.raises(NotEnoughLabels, match="persons"):
        judge(clips, Factor.PERSON)


def test_the_calibration_error_is_the_mean_difference_from_the_truth() -> None:
    distances = np.linspace(0, 2, 1000)
    curve = PairCalibration(3.0, 5.0)
    told = curve.probabilities(distances)
    same = np.random.default_rng(0).uniform(size=1000) < told
    assert calibration_error(curve, distances, same) < 0.05
    assert calibration_error(curve, distances, np.ones(1000, dtype=bool)) == pytest.approx(
        1 - told.mean()
    )


def test_two_clips_for_each_label_are_enough() -> None:
    columns = np.random.default_rng(0).normal(size=(4, 3))
    found = held_out_metric(
        ClipDescriptors(columns, columns, columns),
        [None] * 4,
        list("aabb"),
        list("wxyz"),
        Factor.TASK,
    )
    assert np.isfinite(found.calibration.probability(1.0))
