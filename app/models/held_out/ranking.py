"""Figures of merit for ranked answers, shared by all evaluations.

They are those of Takano (section 3: precision, recall, F where both are equal, eq. 20, top-3
words) and the usual ones of query by example. A ranking is given by scores; a higher score is
closer, and equal scores keep the order of the candidates. Shapes: queries Q, candidates N, words V.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray


def average_precision(scores: FloatArray, is_relevant: BoolArray) -> float:
    """Eq. 20: mean of the precision at each relevant candidate; scores, is_relevant: (N,).

    0.0 if nothing is relevant.
    """
    hits = is_relevant[_best_first(scores)]
    ranks = np.flatnonzero(hits) + 1  # of the relevant candidates, from 1
    if not ranks.size:
        return 0.0
    return float((np.arange(1, ranks.size + 1) / ranks).mean())


def mean_average_precision(scores: FloatArray, is_relevant: BoolArray) -> float:
    """Mean of eq. 20 over the rows of (Q, N) with a relevant candidate; 0.0 without any."""
    rows = np.flatnonzero(is_relevant.any(axis=1))
    precisions = [average_precision(scores[row], is_relevant[row]) for row in rows]
    return float(np.mean(precisions)) if precisions else 0.0


def f_where_recall_is_precision(scores: FloatArray, is_relevant: BoolArray) -> float:
    """F at recall = precision over all pairs at once (micro average); 0.0 if none is relevant.

    scores, is_relevant: any equal shapes. If the number of retrieved pairs equals that of
    relevant pairs, recall = precision = F.
    """
    relevant = int(is_relevant.sum())
    if relevant == 0:
        return 0.0
    return float(is_relevant.ravel()[_best_first(scores.ravel())[:relevant]].mean())


def top_k_rate(scores: FloatArray, labels: BoolArray, k: int) -> float:
    """Share of the rows of (N, V) with labels that have a true label among the k best."""
    rows = np.flatnonzero(labels.any(axis=1))
    has_label = [labels[row, _best_first(scores[row])[:k]].any() for row in rows]
    return float(np.mean(has_label)) if has_label else 0.0


def precision_at_recalls(
    scores: FloatArray, is_relevant: BoolArray, recalls: FloatArray
) -> FloatArray:
    """(r,) precision at the given recalls, over all pairs at once (micro average).

    scores, is_relevant: any equal shapes; recalls: (r,) in 0..1. At least one pair is
    retrieved; 0.0 if none is relevant.
    """
    hits = is_relevant.ravel()[_best_first(scores.ravel())]
    ranks = np.flatnonzero(hits) + 1
    if not ranks.size:
        return np.zeros(len(recalls))
    # the number of relevant pairs that each recall needs; 1e-9 absorbs rounding of the product
    needed = np.clip(np.ceil(recalls * ranks.size - 1e-9).astype(np.int64), 1, ranks.size)
    return np.asarray(needed / ranks[needed - 1])


def calibration_error(probabilities: FloatArray, is_true: BoolArray, bins: int = 10) -> float:
    """Expected calibration error: mean difference of probability and true share in equal bins.

    probabilities, is_true: any equal shapes; each bin has the weight of its members.
    """
    chances, truth = probabilities.ravel(), is_true.ravel().astype(np.float64)
    bin_of = np.clip((chances * bins).astype(np.int64), 0, bins - 1)
    excess = np.bincount(bin_of, chances - truth, minlength=bins)
    return float(np.abs(excess).sum() / max(len(chances), 1))


def brier_score(probabilities: FloatArray, is_true: BoolArray) -> float:
    """Mean squared difference of `probabilities` and the truth `is_true`; any equal shapes."""
    return float(np.square(probabilities - is_true).mean()) if probabilities.size else 0.0


def _best_first(scores: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    return np.argsort(-scores, kind="stable")
