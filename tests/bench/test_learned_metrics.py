"""Learned metrics on clips that they did not learn from.

Run: pytest -m bench -s tests/bench/test_learned_metrics.py
The constants of app.models.metric.learned_metric were chosen on dataset 1, on CMU's clips and on
takes 1 and 2 of dataset 2. Here takes 3 to 5 are the queries, and all of dataset 2 is searched. The
floors (.98 with all labels, .94 with two clips per cell, .80 for new styles and .81 for new tasks)
come from 840 other clips. A cell is a combination of person and task.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import combinations

import numpy as np
import pytest

from app.models.held_out.metric import calibration_error, held_out_metric
from app.models.held_out.ranking import average_precision
from app.models.metric.learned_metric import Factor, fit_axes
from app.models.metric.pair_calibration import calibrate_pairs
from tests.bench.described_clips import RealClips, described_clips
from tests.bench.page import Section

FIGURES = Section(
    "learned_metrics",
    "Learned metrics on clips that they did not learn from",
    trials="takes 3 to 5 of dataset 2 are the queries, and all of dataset 2 is searched",
)

pytestmark = pytest.mark.bench

TAKES = range(1, 6)
JUDGED = 3
"""The first take whose clips are queries."""
FLOORS = {
    (Factor.TASK, "all labels"): 0.98,
    (Factor.TASK, "2 clips a cell"): 0.94,
    (Factor.TASK, "persons never seen"): 0.80,
    (Factor.PERSON, "tasks never seen"): 0.81,
}

Round = tuple[np.ndarray, np.ndarray]
"""Masks of the clips to learn from and of the queries, (n,) each."""


@pytest.fixture(scope="module")
def clips() -> RealClips:
    known = described_clips()
    return known.part(known.takes > 0)


def all_labels(clips: RealClips) -> Iterator[Round]:
    for take in TAKES[JUDGED - 1 :]:
        yield clips.takes != take, clips.takes == take


def takes_a_cell(count: int) -> Callable[[RealClips], Iterator[Round]]:
    def rounds(clips: RealClips) -> Iterator[Round]:
        for taught in combinations(TAKES, count):
            teaches = np.isin(clips.takes, taught)
            if (asks := ~teaches & (clips.takes >= JUDGED)).any():
                yield teaches, asks

    return rounds


def never_seen(labels: Callable[[RealClips], np.ndarray]) -> Callable[[RealClips], Iterator[Round]]:
    def rounds(clips: RealClips) -> Iterator[Round]:
        for name in np.unique(labels(clips)):
            new = labels(clips) == name
            yield ~new, new & (clips.takes >= JUDGED)

    return rounds


def clips_a_label(factor: Factor, count: int) -> Callable[[RealClips], Iterator[Round]]:
    """Learn from `count` clips of each label, drawn from takes 1 and 2."""

    def rounds(clips: RealClips) -> Iterator[Round]:
        labels = labels_of(clips, factor)
        for seed in range(3):
            order = np.random.RandomState(seed).permutation(np.flatnonzero(clips.takes < JUDGED))
            drawn = [order[labels[order] == name][:count] for name in np.unique(labels)]
            teaches = np.isin(np.arange(len(clips)), np.concatenate(drawn))
            yield teaches, clips.takes >= JUDGED

    return rounds


PROTOCOLS: dict[str, Callable[[RealClips], Iterator[Round]]] = {
    "all labels": all_labels,
    "3 clips a cell": takes_a_cell(3),
    "2 clips a cell": takes_a_cell(2),
    "1 clip a cell": takes_a_cell(1),
    "persons never seen": never_seen(lambda clips: clips.persons),
    "tasks never seen": never_seen(lambda clips: clips.tasks),
}


@pytest.mark.parametrize("factor", list(Factor))
def test_unseen_clips_find_clips_with_their_label(clips: RealClips, factor: Factor) -> None:
    FIGURES.print(f"\nmetric-{factor}: unseen takes ask all of dataset 2\n{HEAD}")
    found = {name: judge(clips, factor, rounds) for name, rounds in PROTOCOLS.items()}
    for name, shares in found.items():
        FIGURES.print(table_row(name, shares))
    plain = judge(clips, factor, all_labels, learned=False)
    FIGURES.print(table_row("motion vector", plain))
    for count in (2, 4, 8):
        shares = judge(clips, factor, clips_a_label(factor, count))
        FIGURES.print(table_row(f"{count} clips a {factor}", shares))
        assert shares[2] > plain[2]
    for (of, name), floor in FLOORS.items():
        if of is factor:
            assert found[name][2] >= floor
    curve = [found[f"{n} cell"][2] for n in ("1 clip a", "2 clips a", "3 clips a")]
    assert curve == sorted(curve)


def test_same_style_other_task_and_same_task_other_style(clips: RealClips) -> None:
    """With a filter: metric-person without the query's task, metric-task without its person."""
    FIGURES.print(
        f"\nunseen takes, the query's own task (style) left out\n{'':24}{'P@1':>8}{'P@10':>8}"
    )
    for factor in Factor:
        labels, left_out = labels_of(clips, factor), labels_of(clips, other(factor))
        for name, learned in (("learned", True), ("motion vector", False)):
            rows = []
            for teaches, asks in all_labels(clips):
                points = coordinates(clips, factor, teaches, learned)
                for query in np.flatnonzero(asks):
                    those = np.flatnonzero(left_out != left_out[query])
                    apart = np.linalg.norm(points[those] - points[query], axis=1)
                    same = labels[those[np.argsort(apart, kind="stable")]] == labels[query]
                    rows.append((same[0], same[:10].mean()))
            first, ten = np.mean(rows, axis=0)
            FIGURES.print(f"same {factor}, {name:14}".ljust(24) + f"{first:8.3f}{ten:8.3f}")
            assert not learned or ten > 0.9


@pytest.mark.parametrize("factor", list(Factor))
def test_scores_are_probabilities(clips: RealClips, factor: Factor) -> None:
    """The curve is fitted on held-out takes, and judged on another take."""
    labels = labels_of(clips, factor)
    distances: dict[bool, list[np.ndarray]] = {True: [], False: []}
    same: dict[bool, list[np.ndarray]] = {True: [], False: []}
    for take in TAKES:
        points = coordinates(clips, factor, clips.takes != take, learned=True)
        for query in np.flatnonzero(clips.takes == take):
            others = np.arange(len(clips)) != query
            judged = take >= JUDGED
            distances[judged].append(np.linalg.norm(points[others] - points[query], axis=1))
            same[judged].append(labels[others] == labels[query])
    curve = calibrate_pairs(np.concatenate(distances[False]), np.concatenate(same[False]))
    there, truth = np.concatenate(distances[True]), np.concatenate(same[True])
    scores = curve.probabilities(there)
    FIGURES.print(f"\nmetric-{factor}: score, share with the same label, pairs")
    for low in np.arange(0, 1, 0.2):
        chosen = (scores >= low) & (scores < low + 0.2 + 1e-9)
        FIGURES.print(f"{scores[chosen].mean():8.3f}{truth[chosen].mean():8.3f}{chosen.sum():10}")
    error = calibration_error(curve, there, truth)
    FIGURES.print(f"error {error:.4f}")
    assert error < 0.02


def test_fits_and_queries_are_fast(clips: RealClips) -> None:
    known = described_clips()
    start = time.process_time()
    axes = fit_axes(known.described, known.tasks.tolist(), Factor.TASK)
    fitted = time.process_time() - start
    start = time.process_time()
    persons = [name or None for name in known.persons.tolist()]
    groups = known.recordings.tolist()
    held_out_metric(known.described, persons, known.tasks.tolist(), groups, Factor.TASK)
    judged = time.process_time() - start
    one = known.part(np.arange(len(known)) == 0).described
    start = time.process_time()
    for _ in range(100):
        axes.project(one)
    asked = (time.process_time() - start) / 100
    FIGURES.print(
        f"\n{len(known)} clips: fit {fitted:.2f} s, held-out figures {judged:.2f} s of CPU;"
    )
    FIGURES.print(f"coordinates of a query {1e3 * asked:.2f} ms")
    assert asked < 0.01


HEAD = f"{'':24}{'1-NN':>8}{'P@20':>8}{'MAP':>8}"


def table_row(name: str, shares: np.ndarray) -> str:
    return f"{name:24}" + "".join(f"{share:8.3f}" for share in shares)


def labels_of(clips: RealClips, factor: Factor) -> np.ndarray:
    return clips.tasks if factor is Factor.TASK else clips.persons


def other(factor: Factor) -> Factor:
    return Factor.PERSON if factor is Factor.TASK else Factor.TASK


def coordinates(clips: RealClips, factor: Factor, teaches: np.ndarray, learned: bool) -> np.ndarray:
    if not learned:
        return clips.column("motion_vector")
    labels = [
        name if known else None
        for name, known in zip(labels_of(clips, factor).tolist(), teaches, strict=True)
    ]
    return fit_axes(clips.described, labels, factor).project(clips.described)


def judge(
    clips: RealClips,
    factor: Factor,
    rounds: Callable[[RealClips], Iterator[Round]],
    learned: bool = True,
) -> np.ndarray:
    """Return 1-NN, P@20 and MAP, each the mean over all queries of all rounds."""
    labels, rows = labels_of(clips, factor), []
    for teaches, asks in rounds(clips):
        points = coordinates(clips, factor, teaches, learned)
        for query in np.flatnonzero(asks):
            others = np.arange(len(clips)) != query
            apart = np.linalg.norm(points[others] - points[query], axis=1)
            same = labels[others][np.argsort(apart, kind="stable")] == labels[query]
            average = average_precision(-np.arange(float(len(same))), same)
            rows.append((same[0], same[:20].mean(), average))
    return np.asarray(np.mean(rows, axis=0))
