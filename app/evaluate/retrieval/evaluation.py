"""Query by example: each labeled clip asks for the others of its task (Sun 2011, section 5)."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from app.evaluate.grouping import Grouping, grouped
from app.evaluate.retrieval.labeled import LabeledClips, read_labeled
from app.evaluate.retrieval.rankings import Ranker, Volumes, by_method, by_stored_factors
from app.models.held_out.class_rankings import JudgedRanking, confusion_matrix, true_positive_rates
from app.numerics.arrays import FloatArray
from app.search.example.methods import Method
from app.services import fields
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter

K = 20
"""Number of nearest clips in the paper's figures."""
HIDDEN_CLASSES = 4
"""Number of classes in the paper's experiment 1: walk, run, jump, kick."""
SUN_METHODS = (Method.MSV_DTW, Method.MSV_XCORR)
JUDGED = tuple(method for method in Method if not method.value.startswith("metric-"))
"""All methods except the metrics, which are learned from the same labels."""
MAX_QUERIES = 1000
"""Largest number of queries. Each ranks the whole library by each method; more take hours and do
not change the figures."""

Progress = Callable[[int, int], None]
"""Called after each step with the number of steps done and the total."""


@dataclass(frozen=True, slots=True)
class RetrievalFigures:
    """Figures of query by example with one method; clips with the query's task are relevant.

    nearest: share of queries whose nearest clip is relevant; precision_at_4, precision_at_20
    and mean_average_precision: means over the queries; queries: their number.
    """

    method: str
    nearest: float
    precision_at_4: float
    precision_at_20: float
    mean_average_precision: float
    queries: int


@dataclass(frozen=True, slots=True)
class JudgedMethod:
    """One method's part of the tables.

    rates: (chosen,) true-positive rates of experiment 1; confusion: (C, C) of experiment 2,
    rows are the true classes and sum to 1; by_group: figures of the queries of each group.
    """

    figures: RetrievalFigures
    rates: FloatArray
    confusion: FloatArray
    by_group: Mapping[str, RetrievalFigures] = field(default_factory=dict)

    @property
    def overall(self) -> float:
        """Table 1's last column: the mean over the classes."""
        return float(self.rates.mean())

    @property
    def overall_confusion(self) -> float:
        """The overall mean retrieval rate of figure 8: the mean of the confusion's diagonal."""
        return float(np.diag(self.confusion).mean())


@dataclass(frozen=True, slots=True)
class RetrievalEvaluation:
    """The results of `kinedex evaluate retrieval`.

    methods: results by method; chosen: the classes hidden in the mixture of all `mixture`
    labeled clips; classes: (C,) of the confusion matrix; k: number of nearest clips in both
    experiments; unlabeled: number of clips without a task; alone: number of clips whose task is
    in no other recording (they are in the mixture, but are not queries); sizes: (C,) the number
    of clips of each of `classes`.
    """

    methods: tuple[JudgedMethod, ...]
    chosen: tuple[str, ...]
    classes: tuple[str, ...]
    k: int
    mixture: int
    unlabeled: int
    alone: int
    sizes: tuple[int, ...] = ()


def judge_retrieval(
    lib: Library,
    filter: ClipFilter | None = None,
    methods: Sequence[Method] = JUDGED,
    *,
    classes: Sequence[str] | None = None,
    k: int = K,
    threshold: float = 0.0,
    max_queries: int = MAX_QUERIES,
    by: str | None = None,
    progress: Progress | None = None,
) -> RetrievalEvaluation:
    """Judge each method with the clips that pass the filter as queries for each other.

    Sun's two methods are also judged with q = 1, and with a threshold eta > 0 (body lengths) with
    both q again; beside them stand two rankings by the stored factors (`by_stored_factors`).
    classes: those of table 1, None for the largest four. by: figures for each group of queries too,
    see `Grouping`. Other files of the query's recording, and clips without a task, are ignored.
    Raises NotEnoughLabels, and BadField for a class that cannot be judged or a wrong
    number or grouping.
    """
    _check(k, threshold, max_queries)
    grouping = Grouping.of(by)
    lib.index.catch_up(lib.store)
    lib.paced.catch_up(lib.store)
    labeled = read_labeled(lib, filter)
    chosen = labeled.chosen(classes, HIDDEN_CLASSES)
    queries = labeled.queries(max_queries)
    groups = None if grouping is None else grouping.groups(queries)
    suns = [method for method in methods if method in SUN_METHODS]
    settings = _settings(threshold) if suns else []
    beside = by_stored_factors(lib, labeled.clips) if suns else {}
    step = _stepper(
        len(queries) * (len(methods) + len(suns) * len(settings) + len(beside))
        + len(labeled.clips) * len(settings),
        progress,
    )

    def judge(ranker: Ranker) -> Iterator[JudgedRanking]:
        for clip in queries:
            yield labeled.judge(clip, ranker(clip), k)
            step()

    found = {method.value: list(judge(by_method(lib, method, filter))) for method in methods}
    for q, eta in settings:
        volumes = Volumes.of(lib, labeled.clips, q=q, threshold=eta, step=step)
        for method in suns:
            name = f"{method.value} q={q}" + (f" eta={eta:g}" if eta else "")
            found[name] = list(judge(volumes.by(method)))
    found |= {name: list(judge(ranker)) for name, ranker in beside.items()}
    return _evaluation(labeled, chosen, k, found, groups)


def _check(k: int, threshold: float, max_queries: int) -> None:
    if k < 1:
        raise fields.bad_field("k", "must be at least 1")
    if not (math.isfinite(threshold) and threshold >= 0):
        raise fields.bad_field("threshold", "must be 0 (keep the distances) or above")
    if max_queries < 1:
        raise fields.bad_field("queries", "must be at least 1")


def _settings(threshold: float) -> list[tuple[int, float]]:
    """Pairs (q, eta) to judge in addition to (2, 0), which searches use."""
    return [(1, 0.0)] + ([(1, threshold), (2, threshold)] if threshold else [])


def _stepper(total: int, progress: Progress | None) -> Callable[[], None]:
    """A function to call after each of `total` steps; it reports the progress."""
    done = itertools.count(1)

    def step() -> None:
        if progress is not None:
            progress(next(done), total)

    return step


def _evaluation(
    labeled: LabeledClips,
    chosen: Sequence[str],
    k: int,
    found: Mapping[str, Sequence[JudgedRanking]],
    groups: Sequence[str] | None,
) -> RetrievalEvaluation:
    of_class = [labeled.classes.index(name) for name in chosen]
    count = len(labeled.classes)
    return RetrievalEvaluation(
        methods=tuple(
            JudgedMethod(
                figures=_figures(name, judged),
                rates=true_positive_rates(judged, count)[of_class],
                confusion=confusion_matrix(judged, count),
                by_group=_by_group(name, judged, groups),
            )
            for name, judged in found.items()
        ),
        chosen=tuple(chosen),
        classes=labeled.classes,
        k=k,
        mixture=len(labeled.clips),
        unlabeled=labeled.unlabeled,
        alone=len(labeled.clips) - len(labeled.in_a_class),
        sizes=tuple(np.bincount(list(labeled.code.values()), minlength=count)[:count].tolist()),
    )


def _by_group(
    name: str, judged: Sequence[JudgedRanking], groups: Sequence[str] | None
) -> dict[str, RetrievalFigures]:
    parts = {} if groups is None else grouped(groups, judged)
    return {group: _figures(name, part) for group, part in parts.items()}


def _figures(name: str, judged: Sequence[JudgedRanking]) -> RetrievalFigures:
    nearest, at_4, at_20 = np.mean([one.precision for one in judged], axis=0).tolist()
    average = float(np.mean([one.average_precision for one in judged]))
    return RetrievalFigures(name, nearest, at_4, at_20, average, len(judged))
