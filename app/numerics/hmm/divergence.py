"""Kullback-Leibler divergence between left-to-right models (Takano, eqs 1-2).

The paper draws sequences from one model and compares their likelihoods under both
(`monte_carlo_divergence`, which is slow). The fast way uses the expected path of the source
instead: each state lasts as long as expected. The expected log density of such a frame under a
state of the target has a closed form. These expectations go through the target's recursion. As
Viterbi's algorithm does, it takes the best path to each end state; then it sums over the end
states. The paper's likelihood sums over all paths; `_run` says why ours does not.

All divergences are divided by the number of frames, so they do not depend on the length.
Shapes: source models S, target models M, states K, channels D.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.hmm.model import GaussianHMM, log_likelihood

BLOCK = 500
"""The number of targets that are scored at once: their log probabilities stay in a processor's
cache."""

ALONE_AT_ONCE = 512
"""The number of sources that are scored under themselves at once."""

_LOG_ZERO = np.float32(-1e30)
"""The log probability of an impossible event. It is finite, so that differences are not NaN."""


@dataclass(frozen=True, slots=True)
class _Targets:
    """Models stacked for scoring: a set of M targets for each of S sources.

    weights: (S, 2 D + 1, K, M); a product with the moments of a source gives expected log
    densities. log_stay: (S, 1, K, M). log_move: (S, 1, K - 1, M), of moving into each state but
    the first. The states beyond a model's own are never entered.
    """

    weights: FloatArray
    log_stay: FloatArray
    log_move: FloatArray


def expected_path_divergences(
    sources: Sequence[GaussianHMM], targets: Sequence[GaussianHMM]
) -> FloatArray:
    """(S, M) the divergences d(source || target) of eq. 1, in nats per frame, float64.

    All models must have the same channels; their numbers of states may differ. Values below 0,
    which the approximation can give, become 0.
    """
    divergences = np.zeros((len(sources), len(targets)))
    if not sources or not targets:
        return divergences
    paths = [source.expected_path() for source in sources]
    # neighbors have paths of about one length, and about as many states
    in_order = np.argsort([len(path) for path in paths], kind="stable")
    for some in _parts(in_order, ALONE_AT_ONCE):
        models = [sources[row] for row in some]
        alone = _stack([[model] for model in models])
        divergences[some] = _scores(models, [paths[row] for row in some], alone)
    columns = np.argsort([target.states for target in targets], kind="stable")
    for block in _parts(columns, BLOCK):
        stack = _stack([[targets[column] for column in block]])
        for row, source in enumerate(sources):
            check()
            divergences[row, block] -= _scores([source], [paths[row]], stack)[0]
    return np.maximum(divergences, 0.0)


def _parts(rows: IntArray, size: int) -> list[IntArray]:
    return [rows[first : first + size] for first in range(0, len(rows), size)]


def symmetric_divergences(left: Sequence[GaussianHMM], right: Sequence[GaussianHMM]) -> FloatArray:
    """(L, R) the symmetric divergences (d(i || j) + d(j || i)) / 2 of eq. 2, in nats per frame.

    left: L models, right: R models. If both are the same object, each pair is computed once.
    """
    forward = expected_path_divergences(left, right)
    backward = forward if left is right else expected_path_divergences(right, left)
    return np.asarray((forward + backward.T) / 2.0)


def monte_carlo_divergence(
    source: GaussianHMM, target: GaussianHMM, *, draws: int = 30, seed: int = 0
) -> float:
    """d(source || target) of eq. 1 in nats per frame, by drawing sequences from the source.

    draws: the number of sequences, each of the source's expected length. The result is
    deterministic for a seed; by chance it can be negative.
    """
    from app.numerics.hmm.sampling import sample  # hmmlearn is slow to load

    rng = np.random.RandomState(seed)
    frames = len(source.expected_path())
    total = 0.0
    for _ in range(draws):
        drawn = sample(source, frames, rng)
        total += log_likelihood(source, drawn) - log_likelihood(target, drawn)
    return total / (draws * frames)


def _stack(sets: Sequence[Sequence[GaussianHMM]]) -> _Targets:
    """Some sets of equally many models."""
    shape = len(sets), max(model.states for models in sets for model in models), len(sets[0])
    width = 2 * sets[0][0].means.shape[1] + 1
    weights = np.zeros((shape[0], width, *shape[1:]), dtype=np.float32)
    log_stay = np.zeros((shape[0], 1, *shape[1:]), dtype=np.float32)
    log_move = np.full((shape[0], 1, shape[1] - 1, shape[2]), _LOG_ZERO, dtype=np.float32)
    for row, models in enumerate(sets):
        for column, model in enumerate(models):
            own = model.states
            # log N(x) = -(x^2 - 2 m x + m^2) / 2 v - log(2 pi v) / 2: its expectation is linear in
            # the moments E[x^2], E[x] and 1
            precision = 1.0 / np.asarray(model.variances, dtype=np.float64)
            means = np.asarray(model.means, dtype=np.float64)
            constant = np.log(2.0 * np.pi / precision) + means**2 * precision
            weights[row, :-1, :own, column] = np.hstack([-0.5 * precision, means * precision]).T
            weights[row, -1, :own, column] = -0.5 * constant.sum(axis=1)
            log_stay[row, 0, :own, column] = model.log_stay()
            log_move[row, 0, : own - 1, column] = model.log_move()
    return _Targets(weights, log_stay, log_move)


def _scores(
    sources: Sequence[GaussianHMM], paths: Sequence[IntArray], targets: _Targets
) -> FloatArray:
    """(S, M) the expected log likelihood, in nats per frame, of each source's expected path.

    paths: S, in rising order of length. targets: one set for each source.
    """
    most = max(source.states for source in sources)
    moments = np.zeros((len(sources), most, targets.weights.shape[1]), dtype=np.float32)
    for row, source in enumerate(sources):
        means = np.asarray(source.means, dtype=np.float64)
        seconds = means**2 + source.variances  # E[x^2] in each state
        moments[row, : source.states] = np.hstack([seconds, means, np.ones((source.states, 1))])
    *_, states, count = targets.weights.shape
    # (S, K, 2 D + 1) @ (S, 2 D + 1, K' * M) -> E over the source's state of log density
    expected = moments @ targets.weights.reshape(*targets.weights.shape[:2], -1)
    expected = expected.reshape(len(sources), most, states, count)
    alpha = np.full((len(sources), states, count), _LOG_ZERO, dtype=np.float32)
    alpha[:, 0] = expected[:, 0, 0]  # each path begins in the first state
    stayed = np.add(expected, targets.log_stay, out=expected)
    _run(alpha, stayed, (targets.log_move - targets.log_stay[:, :, 1:])[:, 0], paths)
    largest = alpha.max(axis=1).astype(np.float64)
    totals = largest + np.log(np.exp(alpha - largest[:, None]).sum(axis=1))
    return np.asarray(totals / np.array([len(path) for path in paths])[:, None])


def _run(
    alpha: FloatArray, stayed: FloatArray, more: FloatArray, paths: Sequence[IntArray]
) -> None:
    """Update the log probabilities `alpha` (S, K, M) of the best paths, in place, along `paths`.

    paths: S arrays (frames,), the states of each source, in rising order of length. stayed:
    (S, K_source, K, M) what a frame in each state of the source adds, if the target stays in its
    state; more: (S, K - 1, M) what it adds more if the target moves into the state. Eq. 1 sums over
    both; we take the larger, in a third of the time. Compared with Monte Carlo on 16 real clips,
    both are equally good: Spearman's rank correlation is .9979 (sum: .9980), and the median
    difference 1.7 % (sum: 1.6 %).
    """
    lengths = np.array([len(path) for path in paths])
    states = np.zeros((len(paths), lengths[-1]), dtype=np.int64)
    for row, path in enumerate(paths):
        states[row, : len(path)] = path
    # paths that have ended are left out: they are the first ones
    ended = np.searchsorted(lengths, np.arange(lengths[-1]), side="right")
    moved = np.empty_like(alpha[:, 1:])
    for frame in range(1, int(lengths[-1])):
        first = ended[frame]
        own, out = alpha[first:], moved[first:]
        np.add(own[:, :-1], more[first:], out=out)
        np.maximum(own[:, 1:], out, out=own[:, 1:])
        if len(own) == 1:
            own[0] += stayed[-1, states[-1, frame]]
        else:
            own += stayed[np.arange(first, len(paths)), states[first:, frame]]
