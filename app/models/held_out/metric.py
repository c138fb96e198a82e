"""Held-out figures of a learned metric on clips, tasks and persons that it has not seen.

Rounds hold out clips (all files of a recording together), whole tasks and whole persons
(app.models.holding_out). Each held-out clip with a label ranks all other clips that have a label,
including the training clips, as a query with a new clip does; clips with the same label are
relevant. Other files of its own recording are ignored. The motion vector is judged in the same way
for comparison.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.held_out.ranking import average_precision
from app.models.holding_out import HeldOut, rounds
from app.models.metric.learned_metric import ClipDescriptors, Factor, check_labels, fit_axes
from app.models.metric.pair_calibration import PairCalibration, calibrate_pairs
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import distances

MAX_CLIPS = 1000
"""Of larger libraries, a random subset of this many labeled clips is judged."""

NEAREST = 20
"""Precision is computed among this many nearest clips, or fewer if fewer are relevant."""

MAX_PAIRS = 200_000
"""Largest number of pairs of clips for the calibration."""

MAX_LISTED_LABELS = 200
"""Largest number of labels with a listed number of clips; the rarest labels are listed."""

BINS = 10
"""Number of bins of the calibration error."""

Labels = Sequence[str | None]


@dataclass(frozen=True, slots=True)
class MetricEvaluation:
    """The figures of a metric, and the calibration of its distances.

    figures: JSON-able, by kind of held-out thing; calibration: fitted on the held-out clips.
    """

    figures: dict[str, Any]
    calibration: PairCalibration


@dataclass(frozen=True, slots=True)
class _Judged:
    """The results of the queries of some rounds; each list has one array (m,) for each query.

    learned, plain: whether each clip is relevant, in the order of the learned metric and of the
    motion vectors; distances: learned distances of all clips; same: whether each is relevant.
    """

    learned: list[BoolArray] = field(default_factory=list)
    plain: list[BoolArray] = field(default_factory=list)
    distances: list[FloatArray] = field(default_factory=list)
    same: list[BoolArray] = field(default_factory=list)


def held_out_metric(
    described: ClipDescriptors,
    persons: Labels,
    tasks: Labels,
    groups: Sequence[str],
    factor: Factor,
) -> MetricEvaluation:
    """Judge a metric of `factor` on n clips; groups: (n,) equal for files of one recording.

    Raises NotEnoughLabels if the labels are too few to learn a metric.
    """
    labels = tasks if factor is Factor.TASK else persons
    check_labels(labels, factor)
    counts = Counter(label for label in labels if label)
    index = _judged_clips(labels)
    part = _LabeledClips(
        described.part(index),
        *([names[i] for i in index] for names in (persons, tasks, groups, labels)),
    )
    judged = {kind: _Judged() for kind in HeldOut}
    for kind, training, probes in rounds(part.persons, part.tasks, part.groups):
        _judge_round(part, factor, training, probes, judged[kind])
    clips = judged[HeldOut.CLIPS]
    of_pairs, same = _pairs(clips)
    calibration = calibrate_pairs(of_pairs, same)
    figures = {f"{kind}_held_out": _figures(results) for kind, results in judged.items()}
    document = {name: shares for name, shares in figures.items() if shares}
    error = {"calibration_error": calibration_error(calibration, of_pairs, same)}
    counted = {"labels": _label_counts(counts, by_name=factor is Factor.TASK)}
    return MetricEvaluation(document | error | counted, calibration)


def calibration_error(calibration: PairCalibration, of_pairs: FloatArray, same: BoolArray) -> float:
    """Mean difference, over pairs (n,), between the score and the share with the same label.

    of_pairs: (n,) their distances. The pairs are grouped into BINS bins by their score.
    """
    if not len(of_pairs):
        return 0.0
    scores = calibration.probabilities(of_pairs)
    bins = np.minimum((scores * BINS).astype(np.int64), BINS - 1)
    sizes = np.bincount(bins, minlength=BINS)
    # (BINS,) sum of scores minus number of pairs with the same label
    excess = np.bincount(bins, scores, BINS) - np.bincount(bins, same.astype(np.float64), BINS)
    return float(np.abs(excess).sum() / sizes.sum())


@dataclass(frozen=True, slots=True)
class _LabeledClips:
    """The labeled clips that are judged."""

    described: ClipDescriptors
    persons: list[str | None]
    tasks: list[str | None]
    groups: list[str]
    labels: list[str]


def _judged_clips(labels: Labels) -> IntArray:
    """Ascending indices of at most MAX_CLIPS labeled clips, drawn with a fixed seed."""
    labeled = np.array([i for i, label in enumerate(labels) if label])
    return np.sort(np.random.RandomState(0).permutation(labeled)[:MAX_CLIPS])


def _judge_round(
    part: _LabeledClips, factor: Factor, training: IntArray, probes: IntArray, judged: _Judged
) -> None:
    """Fit without the probes, rank by each probe, and add the results to `judged`."""
    try:
        labels = [part.labels[i] for i in training]
        axes = fit_axes(part.described.part(training), labels, factor)
    except NotEnoughLabels:
        return  # too few labels are left without the probes: this round has no figures
    points = axes.project(part.described)
    names, group = np.array(part.labels), np.array(part.groups)
    vectors = part.described.vectors
    to_all, plain_to_all = distances(points[probes], points), distances(vectors[probes], vectors)
    for row, probe in enumerate(probes.tolist()):
        # other files of the same recording would be trivial matches
        others = np.flatnonzero(group != group[probe])
        same = names[others] == names[probe]
        if not same.any():
            continue
        learned = to_all[row, others]
        judged.learned.append(same[np.argsort(learned, kind="stable")])
        judged.plain.append(same[np.argsort(plain_to_all[row, others], kind="stable")])
        judged.distances.append(learned)
        judged.same.append(same)


def _pairs(judged: _Judged) -> tuple[FloatArray, BoolArray]:
    """Distances (m,) and whether the labels are equal (m,), of at most MAX_PAIRS pairs, taken at
    regular intervals."""
    found = np.concatenate([np.zeros(0), *judged.distances])
    same = np.concatenate([np.zeros(0, dtype=bool), *judged.same])
    step = max(1, -(-len(found) // MAX_PAIRS))
    return found[::step], same[::step]


def _figures(judged: _Judged) -> dict[str, float | int]:
    """Means over the queries; empty without queries."""
    if not judged.learned:
        return {}
    nearest, precision, average = _means(judged.learned)
    return {
        "nearest": nearest,
        "precision_at_20": precision,
        "mean_average_precision": average,
        "motion_vector_map": _means(judged.plain)[2],
        "queries": len(judged.learned),
    }


def _means(rankings: list[BoolArray]) -> list[float]:
    """Means of three figures: the nearest is relevant, precision at NEAREST, average precision."""
    rows = [
        (
            relevant[0],
            relevant[: min(NEAREST, np.count_nonzero(relevant))].mean(),
            average_precision(-np.arange(float(len(relevant))), relevant),
        )
        for relevant in rankings
    ]
    return [float(value) for value in np.mean(rows, axis=0)]


def _label_counts(counts: Counter[str], *, by_name: bool) -> dict[str, Any]:
    """Numbers of clips by label.

    by_name: False for persons. They are not named, because the figures stay stored when a person
    is removed from the library.
    """
    fewest = sorted(counts.items(), key=lambda item: (item[1], item[0]))
    document = {
        "count": len(counts),
        "clips": counts.total(),
        "fewest_clips": fewest[0][1],
        "most_clips": fewest[-1][1],
    }
    return document | ({"clips_of": dict(fewest[:MAX_LISTED_LABELS])} if by_name else {})
