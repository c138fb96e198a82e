"""How well the distances in the motion symbol space agree with the divergences.

Source: Takano, section 3, fig. 3.

The figures are the error T of eq. 3 by the number of dimensions, for classical scaling, SMACOF and
the minimum of the paper's own error (s-stress); the error of placing a symbol by landmarks only;
and the rank correlation of the fast divergence with the Monte Carlo divergence of eqs 1-2.
Symbols N, dimensions d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from app.errors import NotEnoughLabels
from app.models.words.correlated_space import MIN_CLIPS
from app.models.words.correlated_words import CANDIDATES, dimension_losses
from app.models.words.symbol_space import (
    DIMENSIONS,
    fit_symbol_spaces,
    landmark_rows,
    possible_dimensions,
    symbol_distances,
)
from app.models.words.vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray
from app.numerics.hmm.divergence import expected_path_divergences, monte_carlo_divergence
from app.numerics.hmm.model import GaussianHMM
from app.numerics.mds import classical_mds, metric_mds, place, stress
from app.numerics.smacof import smacof

MAX_SYMBOLS = 200
"""Largest number of symbols that are scaled at once. Of more symbols, a random subset is used."""
MAX_DIMENSIONS = 15
MONTE_CARLO_SYMBOLS = 12
"""Number of symbols whose pairs are estimated by Monte Carlo."""
DRAWS = 10
"""Sequences that are drawn for each Monte Carlo estimate."""
MIN_SYMBOLS = 5


@dataclass(frozen=True, slots=True)
class SpaceErrors:
    """The error T of eq. 3 per pair, for one number of dimensions, by scaling method.

    gamma: the share by which one more dimension lowers the error of s_stress, None at the last.
    """

    dimensions: int
    classical: float
    smacof: float
    s_stress: float
    gamma: float | None


@dataclass(frozen=True, slots=True)
class SymbolFigures:
    """Figures of a symbol space.

    symbols: number of scaled symbols; errors: by number of dimensions; placing_error: for
    symbols that are placed by landmarks, the mean absolute difference between the distance and
    its target, divided by the mean target; fitting_error: the same for the landmarks; agreement:
    Spearman's rank correlation of the fast and the Monte Carlo divergences, over `pairs` pairs;
    losses: the mean log loss of held-out words by the number of dimensions of the space (of all
    labeled clips), the smallest of which the word mode "cca" chooses; empty with too few words.
    """

    symbols: int
    errors: tuple[SpaceErrors, ...]
    placing_error: float
    fitting_error: float
    agreement: float
    pairs: int
    losses: dict[int, float]


def symbol_figures(
    symbols: Sequence[GaussianHMM],
    label_sets: Sequence[Sequence[str]] = (),
    groups: Sequence[str] = (),
    *,
    compared: int = MONTE_CARLO_SYMBOLS,
    seed: int = 0,
) -> SymbolFigures:
    """The figures of a library's symbols; deterministic for a seed.

    label_sets, groups: N, the words of each symbol's clip, and keys that files of one recording
    share; without them there are no losses. compared: number of symbols whose pairs are estimated
    by Monte Carlo, which is slow. Raises NotEnoughLabels with fewer than MIN_SYMBOLS symbols.
    """
    if len(symbols) < MIN_SYMBOLS:
        raise NotEnoughLabels(
            f"A symbol space needs {MIN_SYMBOLS} clips, there are {len(symbols)}."
        )
    rng = np.random.RandomState(seed)
    rows = np.sort(rng.permutation(len(symbols))[:MAX_SYMBOLS])
    chosen = [symbols[int(row)] for row in rows]
    distances = symbol_distances(chosen, chosen)
    fitting, placing = _placing_errors(distances, rng)
    compared_symbols = chosen[:: max(len(chosen) // compared, 1)][:compared]
    return SymbolFigures(
        symbols=len(chosen),
        errors=_errors(distances),
        placing_error=placing,
        fitting_error=fitting,
        agreement=_agreement(compared_symbols, seed),
        pairs=len(compared_symbols) * (len(compared_symbols) - 1),
        losses=_losses(symbols, label_sets, groups),
    )


def _losses(
    symbols: Sequence[GaussianHMM], label_sets: Sequence[Sequence[str]], groups: Sequence[str]
) -> dict[int, float]:
    labeled = [row for row, words in enumerate(label_sets) if words]
    if len(labeled) < MIN_CLIPS:
        return {}
    own = [symbols[row] for row in labeled]
    counts = possible_dimensions(CANDIDATES, len(own))
    spaces = fit_symbol_spaces(own, counts)
    away = symbol_distances(own, spaces[0].landmarks)
    points = {count: space.place_at(away) for count, space in zip(counts, spaces, strict=True)}
    words = [label_sets[row] for row in labeled]
    labels = WordVocabulary.of(words).label_matrix(words)
    return dimension_losses(points, labels, [groups[row] for row in labeled])


_Scaling = Callable[[FloatArray, int], FloatArray]


def _errors(distances: FloatArray) -> tuple[SpaceErrors, ...]:
    max_dimensions = min(MAX_DIMENSIONS, len(distances) - 1)
    pairs = len(distances) * (len(distances) - 1) / 2
    methods: tuple[_Scaling, ...] = (classical_mds, smacof, metric_mds)
    errors = [
        [stress(scale(distances, count), distances) / pairs for scale in methods]
        for count in range(1, max_dimensions + 1)
    ]
    return tuple(
        SpaceErrors(count, by_classical, by_smacof, s_stress, _gamma(s_stress, errors[count:]))
        for count, (by_classical, by_smacof, s_stress) in enumerate(errors, 1)
    )


def _gamma(error: float, following: list[list[float]]) -> float | None:
    return (error - following[0][-1]) / error if following and error > 0 else None


def _placing_errors(distances: FloatArray, rng: np.random.RandomState) -> tuple[float, float]:
    """Relative errors of the distances between landmarks, and from other symbols to landmarks."""
    order = rng.permutation(len(distances))
    landmarks = order[: max(len(landmark_rows(len(order))) // 2, MIN_SYMBOLS - 1)]
    others = np.setdiff1d(order, landmarks)
    among, across = distances[np.ix_(landmarks, landmarks)], distances[np.ix_(others, landmarks)]
    points = metric_mds(among, min(DIMENSIONS, len(landmarks) - 1))
    placed = place(across, points)
    return _relative(points, points, among), _relative(placed, points, across)


def _relative(left: FloatArray, right: FloatArray, target: FloatArray) -> float:
    """The mean absolute error of the distances of two sets of points, by the mean target."""
    distances = scipy.spatial.distance.cdist(left, right)
    return float(np.abs(distances - target).mean() / max(float(target.mean()), 1e-12))


def _agreement(symbols: Sequence[GaussianHMM], seed: int) -> float:
    fast = expected_path_divergences(symbols, symbols)
    slow = [
        [monte_carlo_divergence(one, other, draws=DRAWS, seed=seed) for other in symbols]
        for one in symbols
    ]
    different = ~np.eye(len(symbols), dtype=bool)  # a symbol has divergence 0 from itself
    return float(scipy.stats.spearmanr(fast[different], np.array(slow)[different]).statistic)
