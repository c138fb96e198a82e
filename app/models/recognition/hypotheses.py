"""Hypotheses about a clip: a known person does a known task, or something is new.

Each hypothesis is a normal distribution. Shapes: points (n, d) are coordinates of clips;
hypotheses (h,).

There are five kinds. The covariance of each kind is estimated from the errors of predicting real
cells without using them:
- SEEN: a cell of the library. Each task has its own covariance within cells
  (app.models.recognition.within_cells); if each cell has one take, it is the nearest cell mean.
- UNSEEN: a known person at a known task, never recorded together. The mean is the sum of effects.
- NEW_PERSON: a new person who does a known task like one of its persons, with the differences
  between two persons at that task (app.models.recognition.person_differences). A single
  hypothesis at the mean of all persons recognized fewer tasks of new persons: .61 instead of .94
  of 31 clips from CMU, and .83 instead of .87 of 471 clips with each person left out (the figures
  by which this was chosen).
- NEW_TASK: a known person does any other task.
- NEW_BOTH: a new person who does any other task: NEW_TASK with the differences between two
  persons added. So it is wider than NEW_TASK in each direction, and a motion that is far from all
  others is not called that of a known person. With one hypothesis as wide as all cells, it was:
  NEW_TASK, an error of prediction, is wider than that.

Each is there once for clips as recorded and, with disturbed copies (app.models.recognition.copies),
once for each kind of disturbance, whose covariance is added. With it in the only covariance of a
hypothesis, new tasks of dataset 2 are told from known ones with an area under the curve of .955;
without copies with .989; so with .994. SEEN is there once more for mirrored clips
(app.models.recognition.mirrored_cells).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from app.models.cells import Cells, cell_means, fit_effects
from app.models.recognition.kinds import Disturbed, Kind
from app.models.recognition.mirrored_cells import MirroredCells
from app.models.recognition.person_differences import (
    PersonDifferences,
    label_centers,
    person_differences,
)
from app.models.recognition.shrunk import SHRINKAGE, second_moment, shrunk
from app.models.recognition.within_cells import Scatter, scatter_within
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import squared_distances
from app.numerics.shrinkage import oracle_share

MIN_FREEDOM = 5
"""With fewer repeated takes, the covariance within cells is a share of that between cells."""

WITHIN_SHARE = 0.2
"""The variance within a cell as a share of the squared errors of predicted cells, if takes are not
repeated. Measured: .18 in dataset 2, .19 in the demo, .24 in dataset 1. If they are, the pooled
share is at most this. In a library where only dances are repeated, it was 1.6, and no take of any
task was nearer to its cell than a stranger's: the area under the curve was .51, and is .95."""

SEED = 2009
"""Random seed of the simulated takes."""

TAKES_FREEDOM = 8
"""Degrees of freedom of the simulated takes, which are from Student's t: the takes of a wave differ
more than those of a walk, and without repeated takes nobody knows by how much. From one take of
each cell of dataset 2, .15 of later takes are said to be unknown persons, and .13 are; with normal
takes .01 and .17. With 4 degrees .27 and .10, but .13 strangers are called known, not .08."""

MAX_UNSEEN = 20_000
"""Largest number of UNSEEN hypotheses. A library with more such combinations gets none."""


@dataclass(frozen=True, slots=True)
class Hypotheses:
    """h hypotheses.

    person, task: (h,) label indices, -1 for new; kind: (h,) the `Kind`; disturbed: (h,) the
    `Disturbed`; form: (h,) index of the covariance, in ascending order; means: (h, d), whitened;
    spread: (h,) factor on the covariance; whiteners: (forms, d, d), `point @ whiteners[form]` is
    the whitened point; log_scale: (forms,) half the log determinants.
    """

    means: FloatArray
    person: IntArray
    task: IntArray
    kind: IntArray
    disturbed: IntArray
    form: IntArray
    spread: FloatArray
    whiteners: FloatArray
    log_scale: FloatArray

    def further_takes(self, count: int, max_cells: int) -> FloatArray:
        """(n, d) random takes of SEEN cells, as recorded, lightly disturbed or mirrored.

        There are `count` takes of each of at most `max_cells` cells. The seed is fixed.
        """
        seen = np.flatnonzero((self.kind == Kind.SEEN) & (self.disturbed != Disturbed.CUT))
        seen = seen[np.linspace(0, len(seen) - 1, min(len(seen), max_cells)).astype(np.int64)]
        seen = np.repeat(seen, count)
        rng = np.random.default_rng(SEED)
        dimensions = self.means.shape[1]
        drawn = rng.standard_normal((len(seen), dimensions + TAKES_FREEDOM))
        # Student's t: normal numbers divided by the root mean square of `freedom` others
        sizes = np.sqrt(np.square(drawn[:, dimensions:]).mean(axis=1, keepdims=True))
        drawn = drawn[:, :dimensions] / sizes
        return self._unwhitened(
            self.means[seen] + np.sqrt(self.spread[seen])[:, None] * drawn, seen
        )

    def centers(self, which: IntArray) -> FloatArray:
        """(n, d) the means of the hypotheses `which` (n,), in the coordinates of clips."""
        return self._unwhitened(self.means[which], which)

    def _unwhitened(self, white: FloatArray, which: IntArray) -> FloatArray:
        """(n, d) the points that the forms of the hypotheses `which` (n,) whiten to `white`."""
        out = np.empty_like(white)
        for form in np.unique(self.form[which]):
            own = self.form[which] == form
            # white = point @ whitener, so the point solves whitener.T @ point = white
            out[own] = np.linalg.solve(self.whiteners[form].T, white[own].T).T
        return out

    def log_likelihoods(self, points: FloatArray, freedom: float | None = None) -> FloatArray:
        """(n, h) log densities of `points` (n, d), up to a constant.

        They are Gaussian, or, with degrees of `freedom`, Student's t, which has heavier tails.
        """
        return self.log_densities(self.squares(points), freedom)

    def log_densities(self, squares: FloatArray, freedom: float | None = None) -> FloatArray:
        """As `log_likelihoods`, from the result of `squares` (n, h)."""
        dimensions = self.means.shape[1]
        volume = self.log_scale[self.form] + 0.5 * dimensions * np.log(self.spread)
        if freedom is None:
            return np.asarray(-0.5 * squares - volume)
        return np.asarray(-0.5 * (freedom + dimensions) * np.log1p(squares / freedom) - volume)

    def squares(self, points: FloatArray) -> FloatArray:
        """(n, h) squared Mahalanobis distances of `points` (n, d) from the means."""
        out = np.empty((len(points), len(self.form)))
        # the hypotheses of one form are neighbors in the order
        starts = np.searchsorted(self.form, np.arange(len(self.whiteners) + 1))
        for form, (start, end) in enumerate(pairwise(starts)):
            white = points @ self.whiteners[form]
            out[:, start:end] = squared_distances(white, self.means[start:end])
        return np.asarray(out / self.spread)


@dataclass(frozen=True, slots=True)
class _Group:
    """Hypotheses that share a covariance, before whitening; fields as in Hypotheses."""

    kind: Kind
    means: FloatArray
    person: IntArray
    task: IntArray
    covariance: FloatArray
    spread: FloatArray
    disturbed: Disturbed = Disturbed.NOT

    def after(self, what: Disturbed, moments: FloatArray) -> _Group:
        """The same hypotheses about disturbed clips; moments: (d, d) of the differences."""
        return replace(self, disturbed=what, covariance=self.covariance + moments)


def fit_hypotheses(
    points: FloatArray,
    cells: Cells,
    disturbances: Mapping[Disturbed, FloatArray] | None = None,
    mirrored: MirroredCells | None = None,
) -> Hypotheses:
    """The hypotheses for a library with the labeled `points` (clips, d) in `cells`.

    disturbances: for each kind the (d, d) second moments of copies minus clips; None without
    copies; mirrored: the mirrored cells, in the same coordinates; None without any.
    """
    means = cell_means(points, cells)
    total = shrunk(np.cov(means.T, bias=True).reshape(2 * [points.shape[1]]))
    differences = person_differences(means, cells, total)
    unseen = _unseen(means, cells, total)
    seen = _seen(points, means, cells, WITHIN_SHARE * unseen.covariance, differences.size)
    new_person = _new_person(means, cells, differences)
    new_task = _new_task(means, cells, total)
    new_both = _new_both(means, new_task, differences.covariance, total)
    recorded = [*seen, unseen, new_person, new_task, new_both]
    kinds = (disturbances or {}).items()
    disturbed = [group.after(what, moments) for what, moments in kinds for group in recorded]
    others = _mirrored(mirrored, seen) if mirrored and seen else []
    return _whitened(recorded + disturbed + others)


def _seen(
    points: FloatArray, means: FloatArray, cells: Cells, most: FloatArray, size: FloatArray
) -> list[_Group]:
    """A group for each task with repeated takes, and one group for all other cells.

    most: (d, d) the covariance if the library has fewer than MIN_FREEDOM repeated takes, and the
    largest variance that the pooled one of more takes may have; size: (tasks + 1,) the factor for
    each task.
    """
    full = np.flatnonzero(cells.full)
    inside = np.flatnonzero(np.isin(cells.member, full))
    deviations = points[inside] - means[cells.member[inside]]
    deviations = deviations / np.sqrt(size[cells.task[cells.member[inside]]])[:, None]
    freedom = len(deviations) - len(full)
    if freedom < MIN_FREEDOM:
        scatter = Scatter.same(most, cells)
    else:
        within = deviations.T @ deviations / freedom
        within *= min(1.0, float(np.trace(most)) / max(float(np.trace(within)), 1e-12))
        pooled = shrunk(within, max(SHRINKAGE, oracle_share(within, freedom)))
        scatter = scatter_within(deviations, cells.member[inside], cells, pooled)
    spread = scatter.spread * size[cells.task] * (1 + 1 / np.maximum(cells.takes, 1))
    return [
        _Group(Kind.SEEN, means[own], cells.person[own], cells.task[own], covariance, spread[own])
        for form, covariance in enumerate(scatter.covariances)
        if len(own := full[scatter.form[full] == form])
    ]


def _mirrored(cells: MirroredCells, seen: list[_Group]) -> list[_Group]:
    """SEEN at the means of mirrored cells.

    A mirrored cell is as wide as the recorded cell of its person and task. If there is none, it has
    the covariance of most cells and their median width.
    """
    usual = max(range(len(seen)), key=lambda group: len(seen[group].means))
    width = usual, float(np.median(seen[usual].spread))
    recorded = {
        (person, task): (group, spread)
        for group, own in enumerate(seen)
        for person, task, spread in zip(own.person, own.task, own.spread, strict=True)
    }
    found = [recorded.get(pair, width) for pair in zip(cells.person, cells.task, strict=True)]
    group, spread = (np.array(part) for part in zip(*found, strict=True))
    return [
        _Group(
            Kind.SEEN,
            cells.means[own],
            cells.person[own],
            cells.task[own],
            seen[each].covariance,
            spread[own],
            Disturbed.MIRRORED,
        )
        for each in np.unique(group)
        if len(own := np.flatnonzero(group == each))
    ]


def _unseen(means: FloatArray, cells: Cells, fallback: FloatArray) -> _Group:
    """UNSEEN: one hypothesis for each pair of person and task that was never recorded."""
    effects = fit_effects(means, cells)
    person, task = np.nonzero(_missing(cells))
    enough = len(effects.errors) >= MIN_FREEDOM
    spread = second_moment(effects.errors) if enough else fallback
    predicted = effects.predict(person, task)
    return _Group(Kind.UNSEEN, predicted, person, task, spread, np.ones(len(person)))


def _missing(cells: Cells) -> BoolArray:
    """(persons, tasks) whether the two were never recorded together.

    All False if there are more than MAX_UNSEEN such pairs.
    """
    missing = np.ones((len(cells.persons), len(cells.tasks)), dtype=bool)
    full = cells.full
    missing[cells.person[full], cells.task[full]] = False
    return np.asarray(missing & (missing.sum() <= MAX_UNSEEN))


def _new_person(means: FloatArray, cells: Cells, differences: PersonDifferences) -> _Group:
    """NEW_PERSON: one hypothesis for each cell with a task label."""
    has = np.flatnonzero(cells.task >= 0)
    no_label, task = np.full(len(has), -1), cells.task[has]
    covariance, spread = differences.covariance, differences.size[task]
    return _Group(Kind.NEW_PERSON, means[has], no_label, task, covariance, spread)


def _new_task(means: FloatArray, cells: Cells, fallback: FloatArray) -> _Group:
    """NEW_TASK: one hypothesis for each person, at the mean of their cells (equal weights)."""
    label, labels = cells.person, len(cells.persons)
    has = np.flatnonzero(label >= 0)
    counts = np.bincount(label[has], minlength=labels)
    centers = label_centers(means, label, labels)
    several = has[counts[label[has]] > 1]
    others = counts[label[several]] - 1
    # m - c times (1 + 1/others) is the cell minus the mean of the person's other cells
    errors = (means[several] - centers[label[several]]) * (1 + 1 / others)[:, None]
    covariance = second_moment(errors) if len(errors) >= MIN_FREEDOM else fallback
    index, no_label = np.arange(labels), np.full(labels, -1)
    return _Group(Kind.NEW_TASK, centers, index, no_label, covariance, np.ones(labels))


def _new_both(
    means: FloatArray, new_task: _Group, differences: FloatArray, fallback: FloatArray
) -> _Group:
    """NEW_BOTH: one hypothesis for each person, as NEW_TASK, for a person who differs from that
    one by `differences` (d, d). Without persons, one with the covariance `fallback` (d, d)."""
    centers: FloatArray = new_task.means
    covariance: FloatArray = new_task.covariance + differences
    if not len(centers):
        centers, covariance = np.asarray(means.mean(axis=0, keepdims=True)), fallback
    no_label = np.full(len(centers), -1)
    return _Group(Kind.NEW_BOTH, centers, no_label, no_label, covariance, np.ones(len(centers)))


def _whitened(groups: list[_Group]) -> Hypotheses:
    """All groups as one record; each group has a form, with its number."""
    factors = [np.linalg.cholesky(group.covariance) for group in groups]
    whiteners = [np.linalg.inv(factor).T for factor in factors]
    white = [group.means @ by for group, by in zip(groups, whiteners, strict=True)]
    sizes = [len(group.means) for group in groups]
    return Hypotheses(
        means=np.concatenate(white),
        person=np.concatenate([group.person for group in groups]),
        task=np.concatenate([group.task for group in groups]),
        kind=np.repeat([int(group.kind) for group in groups], sizes),
        disturbed=np.repeat([int(group.disturbed) for group in groups], sizes),
        form=np.repeat(np.arange(len(groups)), sizes),
        spread=np.concatenate([group.spread for group in groups]),
        whiteners=np.stack(whiteners),
        log_scale=np.array([float(np.log(np.diag(factor)).sum()) for factor in factors]),
    )
