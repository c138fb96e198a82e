"""Left-to-right hidden Markov models with diagonal Gaussian states (Takano, section 2.1).

A model begins in its first state, stays or moves to the next one, and may end in any
state: forcing the last one makes short samples impossible and divergences infinite.
Everything is computed in the log domain. Models are fitted and sampled by hmmlearn
(app.numerics.hmm.fit); this module holds what they are and scores sequences with them.
Shapes: frames T, states K, channels D, models M.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray, IntArray

MAX_EMISSIONS = 2_000_000
"""Log densities (frames x states x models) computed at once; bounds memory to some 50 MB."""

MIN_PROBABILITY = 1e-10
"""Transitions are floored here before their logarithm is taken, so that none is -inf."""


@dataclass(frozen=True, slots=True)
class GaussianHMM:
    """A left-to-right model: transitions (K, K), rows sum to one, only stay and next are
    not zero; means (K, D); variances (K, D), positive; units are those of the channels.
    """

    transitions: FloatArray
    means: FloatArray
    variances: FloatArray

    @property
    def states(self) -> int:
        """K, the number of states."""
        return int(self.means.shape[0])

    def log_stay(self) -> FloatArray:
        """(K,) log probability of staying in each state."""
        stay = np.diagonal(self.transitions).astype(np.float64)
        return np.asarray(np.log(np.maximum(stay, MIN_PROBABILITY)))

    def log_move(self) -> FloatArray:
        """(K - 1,) log probability of moving from each state to the next."""
        move = np.diagonal(self.transitions, offset=1).astype(np.float64)
        return np.asarray(np.log(np.maximum(move, MIN_PROBABILITY)))

    def dwell(self) -> FloatArray:
        """(K,) expected frames in each state, 1 / (1 - stay), at least one.

        The last state has no way out: it is given the mean of the others.
        """
        leave = 1.0 - np.diagonal(self.transitions)[:-1].astype(np.float64)
        frames = 1.0 / np.maximum(leave, 1e-4)
        return np.append(frames, frames.mean() if frames.size else 1.0)

    def expected_path(self) -> IntArray:
        """(frames,) the state of each frame when every state lasts as long as expected.

        States end at the rounded sum of the dwells before, so rounding does not pile up.
        """
        ends = np.maximum(np.rint(np.cumsum(self.dwell())), np.arange(1, self.states + 1))
        return np.repeat(np.arange(self.states), np.diff(ends, prepend=0).astype(np.int64))


def mean_trajectory(model: GaussianHMM) -> FloatArray:
    """(frames, D) the model's means along its expected path: the motion it stands for."""
    return np.asarray(model.means[model.expected_path()], dtype=np.float64)


def log_emissions(sequence: FloatArray, means: FloatArray, variances: FloatArray) -> FloatArray:
    """(T, K) log density of every frame of `sequence` (T, D) in every state.

    means, variances: (K, D).
    """
    precision = 1.0 / variances
    # (x - m)^2 / v summed over D as three products: (T, D) @ (D, K)
    squares = (
        (sequence**2) @ precision.T
        - 2.0 * (sequence @ (means * precision).T)
        + (means**2 * precision).sum(axis=1)
    )
    constant = np.log(2.0 * np.pi * variances).sum(axis=1)
    return np.asarray(-0.5 * (squares + constant))


def log_likelihood(model: GaussianHMM, sequence: FloatArray) -> float:
    """log P(sequence (T, D) | model), summed over end states."""
    emissions = log_emissions(sequence, model.means, model.variances)
    last = forward(emissions, model.log_stay(), model.log_move())[-1]
    return float(np.logaddexp.reduce(last))


def log_likelihoods(models: Sequence[GaussianHMM], sequence: FloatArray) -> FloatArray:
    """(M,) log P(sequence | model) of each model: which symbol is this motion (Takano 2.4)?

    As log_likelihood, for many models at once. This stays ours: 50 models score a clip of 5 s in
    11.5 ms, hmmlearn one after the other in 73 (tests/bench/test_libraries.py). Its faster way,
    with plain probabilities, underflows under models of other motion.
    """
    if not models:
        return np.zeros(0)
    states = max(model.states for model in models)
    at_once = max(1, MAX_EMISSIONS // (len(sequence) * states))
    parts = [
        _log_likelihoods(models[first : first + at_once], sequence, states)
        for first in range(0, len(models), at_once)
    ]
    return np.concatenate(parts)


def _log_likelihoods(
    models: Sequence[GaussianHMM], sequence: FloatArray, states: int
) -> FloatArray:
    """(M,); models with fewer states get ones that are never entered."""
    emissions = np.zeros((len(sequence), states, len(models)))
    log_stay = np.zeros((states, len(models)))
    log_move = np.full((states - 1, len(models)), -np.inf)
    for column, model in enumerate(models):
        own = model.states
        emissions[:, :own, column] = log_emissions(sequence, model.means, model.variances)
        log_stay[:own, column] = model.log_stay()
        log_move[: own - 1, column] = model.log_move()
    return np.asarray(np.logaddexp.reduce(forward(emissions, log_stay, log_move)[-1], axis=0))


def forward(emissions: FloatArray, log_stay: FloatArray, log_move: FloatArray) -> FloatArray:
    """(T, K) log probability of the frames so far and of being in each state now.

    emissions: (T, K) log densities; log_stay: (K,); log_move: (K - 1,); each may have a further
    axis, of models.
    One running sum over time for each state, instead of one step over states for each
    frame: with c_t = sum of (stay + emission) up to t, a state entered at s has
    log alpha_t = c_t + log sum_{s <= t} exp(enter_s - c_s).
    """
    stays = np.cumsum(emissions + log_stay, axis=0)
    alpha = np.full(emissions.shape, -np.inf)
    alpha[:, 0] = stays[:, 0] - log_stay[0]  # the first frame is not a transition
    for state in range(1, emissions.shape[1]):
        enter = alpha[:-1, state - 1] + log_move[state - 1] + emissions[1:, state]
        alpha[1:, state] = stays[1:, state] + np.logaddexp.accumulate(enter - stays[1:, state])
    return alpha
