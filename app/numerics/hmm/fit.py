"""Left-to-right models of one sequence, fitted with hmmlearn's compiled core (Takano, section 2.1).

hmmlearn's own classes do not fit here: they load scikit-learn and pandas, which takes a second of
CPU and 35 MB in each process, their checks take longer than the fit of a clip, and their
`min_covar` acts only before the first M-step. So this module has the loop of the
expectation-maximization (EM): a start from equal parts, a prior on the allowed transitions, and a
variance floor in every M-step. The steps over frames are hmmlearn's. A textbook's EM is its twin in
the tests. Shapes: frames T, states K, channels D.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from hmmlearn import _hmmc

from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM, log_emissions

TRANSITION_PRIOR = 1.01
"""Dirichlet parameter of the allowed transitions. It keeps their probabilities in short clips
above zero."""

ITERATIONS = 3
"""The largest number of iterations. On the real clips, divergences after 3 iterations rank as
after 5 (Spearman .9999), and search by words is equally good."""

MIN_GAIN = 1e-3
"""Iterations stop if one gains less log likelihood per frame than this (nats)."""

FRAMES_PER_STATE = 3
"""A state needs at least this many frames. Short sequences get fewer states."""

MAX_CHANNEL = 1e100
"""The largest magnitude of a channel. Squares of larger values would overflow."""

MIN_FRAMES = 1e-5
"""A state that expects fewer frames has the variances of this many."""


def fit_left_to_right(
    sequence: FloatArray,
    *,
    states: int,
    variance_floor: FloatArray,
    iterations: int = ITERATIONS,
) -> GaussianHMM:
    """Fit a model to `sequence` (T, D), T >= 1. The result is deterministic.

    states: the number of states; short sequences get fewer (`states_for`). variance_floor: (D,)
    or a scalar, positive, in the squared units of the channels. iterations: the largest number
    of EM iterations. The fit starts from the sequence cut into equal parts. It takes 2.8 ms for
    a clip of 6 s.

    Raises ValueError if a value is NaN or its magnitude is above MAX_CHANNEL.
    """
    data = np.asarray(sequence, dtype=np.float64)
    if not (np.abs(data) <= MAX_CHANNEL).all():
        raise ValueError(f"expected channels within {MAX_CHANNEL:g}, found larger ones or NaN")
    floor = np.broadcast_to(np.asarray(variance_floor, dtype=np.float64), data.shape[1:])
    center = data.mean(axis=0)  # keeps the products of log_emissions well conditioned
    start = _equal_parts(data - center, states_for(len(data), states), floor)
    model = _improve(start, data - center, floor, iterations) if iterations else start
    return GaussianHMM(model.transitions, model.means + center, model.variances)


def states_for(frames: int, states: int) -> int:
    """The number of states, 1..`states`, that a sequence of `frames` frames can fill."""
    return max(1, min(states, frames // FRAMES_PER_STATE))


def _improve(
    start: GaussianHMM, data: FloatArray, floor: FloatArray, iterations: int
) -> GaussianHMM:
    """The model after at most `iterations` iterations of EM from `start`.

    data: (T, D). floor: (D,) the smallest variances.
    """
    try:
        # Plain probabilities are fast. If a frame is far from every state, they become 0, or
        # the factors that scale them overflow.
        with np.errstate(over="raise", invalid="raise", under="ignore"):
            return _after_em(start, data, floor, iterations, _expected)
    except (ValueError, FloatingPointError):
        with np.errstate(under="ignore"):
            return _after_em(start, data, floor, iterations, _expected_by_logarithms)


@dataclass(frozen=True, slots=True)
class _Expected:
    """What an E-step finds. log_likelihood: nats. occupancy: (T, K) the probability of each state
    in each frame. moves: (K, K) the expected number of transitions."""

    log_likelihood: float
    occupancy: FloatArray
    moves: FloatArray


def _after_em(
    model: GaussianHMM,
    data: FloatArray,
    floor: FloatArray,
    iterations: int,
    expect: Callable[[GaussianHMM, FloatArray], _Expected],
) -> GaussianHMM:
    """`model` after EM. expect: the E-step, of a model and data."""
    squares = data**2
    before = -np.inf
    for _ in range(iterations):
        expected = expect(model, data)
        model = _maximized(model, expected, data, squares, floor)
        if expected.log_likelihood - before < MIN_GAIN * len(data):
            break
        before = expected.log_likelihood
    return model


def _maximized(
    model: GaussianHMM,
    expected: _Expected,
    data: FloatArray,
    squares: FloatArray,
    floor: FloatArray,
) -> GaussianHMM:
    """The M-step (Huang, Acero, Hon 2001, "Spoken Language Processing", p. 443)."""
    # Every state is visited, since none can be skipped: nothing is divided by zero.
    frames = expected.occupancy.sum(axis=0)[:, None]
    sums = expected.occupancy.T @ data
    means = sums / frames
    spread = expected.occupancy.T @ squares - 2 * means * sums + means**2 * frames
    counts = np.where(model.transitions > 0, TRANSITION_PRIOR - 1 + expected.moves, 0.0)
    return GaussianHMM(
        transitions=counts / counts.sum(axis=1, keepdims=True),
        means=means,
        variances=np.maximum(spread / np.maximum(frames, MIN_FRAMES), floor),
    )


def _expected(model: GaussianHMM, data: FloatArray) -> _Expected:
    """The E-step with plain probabilities.

    Raises ValueError or FloatingPointError if they become 0 or overflow.
    """
    first, moves = _first(model), model.transitions
    densities = np.exp(log_emissions(data, model.means, model.variances))
    log_likelihood, ahead, factors = _hmmc.forward_scaling(first, moves, densities)
    back = _hmmc.backward_scaling(first, moves, densities, factors)
    found = np.zeros_like(moves)
    if len(data) > 1:
        found = _hmmc.compute_scaling_xi_sum(ahead, moves, back, densities)
    occupancy = ahead * back
    occupancy /= occupancy.sum(axis=1, keepdims=True)
    return _Expected(log_likelihood, occupancy, found)


def _expected_by_logarithms(model: GaussianHMM, data: FloatArray) -> _Expected:
    """The E-step with logarithms of probabilities."""
    first, moves = _first(model), model.transitions
    densities = log_emissions(data, model.means, model.variances)
    log_likelihood, ahead = _hmmc.forward_log(first, moves, densities)
    back = _hmmc.backward_log(first, moves, densities)
    found = np.zeros_like(moves)
    if len(data) > 1:
        found = np.exp(_hmmc.compute_log_xi_sum(ahead, moves, back, densities))
    both = ahead + back
    occupancy = np.exp(both - np.logaddexp.reduce(both, axis=1, keepdims=True))
    return _Expected(log_likelihood, occupancy, found)


def _first(model: GaussianHMM) -> FloatArray:
    """(K,) the probabilities of the first state: a model begins in its first one."""
    first = np.zeros(model.states)
    first[0] = 1.0
    return first


def _equal_parts(data: FloatArray, states: int, floor: FloatArray) -> GaussianHMM:
    """A model of `states` states, each of an equal part of `data` (T, D)."""
    edges = np.linspace(0, len(data), states + 1).round().astype(np.int64)
    starts, lengths = edges[:-1], np.diff(edges)[:, None]
    means = np.add.reduceat(data, starts, axis=0) / lengths
    squares = np.add.reduceat(data**2, starts, axis=0) / lengths
    leave = 1.0 / lengths[:, 0]
    # A part of one frame would stay with probability zero, and EM could not change that.
    transitions = _left_to_right(np.maximum(1.0 - leave, 1e-3), leave)
    return GaussianHMM(transitions, means, np.maximum(squares - means**2, floor))


def _left_to_right(stay: FloatArray, move: FloatArray) -> FloatArray:
    """(K, K) transitions from `stay` (K,) and `move` (K,), whose rows sum to 1.

    The model never leaves its last state.
    """
    transitions = np.diag(stay) + np.diag(move[:-1], 1)
    transitions[-1] = 0.0
    transitions[-1, -1] = 1.0
    return np.asarray(transitions / transitions.sum(axis=1, keepdims=True))
