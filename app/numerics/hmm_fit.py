"""Expectation-maximisation for left-to-right models of one sequence (Takano, section 2.1).

The same steps as hmmlearn's GaussianHMM with diagonal covariances (a test holds one
against the other), about ten times faster because only two diagonals of the transition
matrix exist. The variance floor is applied inside every M-step (DESIGN 5).
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.hmm import GaussianHMM, backward, forward, log_emissions

TRANSITION_PRIOR = 1.01
"""Dirichlet parameter of the allowed transitions: keeps rows of short clips from emptying."""

ITERATIONS = 3
"""Most iterations; on the real clips divergences after these rank as after 5 (Spearman
.9999), and words are found as well."""

LEAST_GAIN = 1e-3
"""Stop when an iteration gains less log likelihood per frame than this."""

FRAMES_PER_STATE = 3
"""A state needs at least so many frames; short sequences get fewer states."""

LEAST_OCCUPANCY = 1e-6
"""A state visited less than this (frames) keeps its mean and variance."""


def fit_left_to_right(
    sequence: FloatArray,
    *,
    states: int,
    variance_floor: FloatArray,
    iterations: int = ITERATIONS,
) -> GaussianHMM:
    """Fit a model to `sequence` (T, D), T >= 1; deterministic, never fails.

    states: wanted number, fewer for short sequences; variance_floor: (D,), positive, in
    the squared units of the channels. Starts from cutting the sequence into equal parts.
    """
    data = np.asarray(sequence, dtype=np.float64)
    floor = np.broadcast_to(np.asarray(variance_floor, dtype=np.float64), data.shape[1:])
    centre = data.mean(axis=0)  # keeps the products of log_emissions well conditioned
    model = _equal_parts(data - centre, states_for(len(data), states), floor)
    before = -np.inf
    for _ in range(iterations):
        model, gained = _improve(model, data - centre, floor)
        if gained - before < LEAST_GAIN * len(data):
            break
        before = gained
    return GaussianHMM(model.transitions, model.means + centre, model.variances)


def states_for(frames: int, states: int) -> int:
    """How many of the wanted states a sequence of so many frames can fill."""
    return max(1, min(states, frames // FRAMES_PER_STATE))


def _equal_parts(data: FloatArray, states: int, floor: FloatArray) -> GaussianHMM:
    edges = np.linspace(0, len(data), states + 1).round().astype(np.int64)
    starts, lengths = edges[:-1], np.diff(edges)[:, None]
    means = np.add.reduceat(data, starts, axis=0) / lengths
    squares = np.add.reduceat(data**2, starts, axis=0) / lengths
    leave = 1.0 / lengths[:, 0]
    # A one-frame part would stay with probability zero and never learn otherwise.
    transitions = _left_to_right(np.maximum(1.0 - leave, 1e-3), leave)
    return GaussianHMM(transitions, means, np.maximum(squares - means**2, floor))


def _improve(model: GaussianHMM, data: FloatArray, floor: FloatArray) -> tuple[GaussianHMM, float]:
    """One EM step; returns the better model and the log likelihood of the old one."""
    log_stay, log_move = model.log_stay(), model.log_move()
    emissions = log_emissions(data, model.means, model.variances)
    alpha = forward(emissions, log_stay, log_move)
    beta = backward(emissions, log_stay, log_move)
    total = float(np.logaddexp.reduce(alpha[-1]))
    occupancy = np.exp(alpha + beta - total)  # (T, K)
    ahead = emissions[1:] + beta[1:] - total  # (T - 1, K)
    stays = np.exp(alpha[:-1] + log_stay + ahead).sum(axis=0)
    moves = np.exp(alpha[:-1, :-1] + log_move + ahead[:, 1:]).sum(axis=0)
    means, variances = _states(model, data, occupancy, floor)
    prior = TRANSITION_PRIOR - 1.0
    transitions = _left_to_right(stays + prior, np.append(moves + prior, 0.0))
    return GaussianHMM(transitions, means, variances), total


def _states(
    model: GaussianHMM, data: FloatArray, occupancy: FloatArray, floor: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Means and variances (K, D) by occupancy (T, K); a state nobody visits stays as it is."""
    frames = occupancy.sum(axis=0)[:, None]
    is_visited = frames > LEAST_OCCUPANCY
    weight = 1.0 / np.where(is_visited, frames, 1.0)
    means = np.where(is_visited, (occupancy.T @ data) * weight, model.means)
    spread = (occupancy.T @ data**2) * weight - means**2
    variances = np.where(is_visited, np.maximum(spread, floor), model.variances)
    return means, variances


def _left_to_right(stay: FloatArray, move: FloatArray) -> FloatArray:
    """(K, K) rows summing to one; the last state only stays."""
    transitions = np.diag(stay) + np.diag(move[:-1], 1)
    transitions[-1] = 0.0
    transitions[-1, -1] = 1.0
    return np.asarray(transitions / transitions.sum(axis=1, keepdims=True))
