"""Left-to-right models of one sequence, fitted by hmmlearn (Takano, section 2.1).

hmmlearn does the expectation-maximization (EM), the sampling and the state probabilities. The
subclass below adds what a motion symbol needs: a start from equal parts, a prior on the
allowed transitions, and a variance floor in every M-step (hmmlearn's `min_covar` acts only
before the first one).

hmmlearn takes .25 s and 35 MB to load. So import this module inside the function that needs it.
Shapes: frames T, states K, channels D.
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from hmmlearn import hmm

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

# hmmlearn warns of short clips and of a likelihood that falls. Both are usual here: the prior
# and the floor can lower the likelihood. Only real errors may reach the service's log.
logging.getLogger("hmmlearn").setLevel(logging.ERROR)


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


def sample(model: GaussianHMM, frames: int, rng: np.random.RandomState) -> FloatArray:
    """(frames, D) one sequence drawn from the model.

    rng: a RandomState, because hmmlearn takes no newer generator.
    """
    drawn, _ = _LeftToRight(model).sample(frames, random_state=rng)
    return np.asarray(drawn, dtype=np.float64)


def occupancy(model: GaussianHMM, sequence: FloatArray) -> FloatArray:
    """(T, K) the probability of each state at each frame of `sequence` (T, D); rows sum to 1."""
    center = sequence.mean(axis=0)
    centered = GaussianHMM(model.transitions, model.means - center, model.variances)
    # logarithms: under a model of other motion, plain probabilities underflow
    learner = _LeftToRight(centered, implementation="log")
    return np.asarray(learner.predict_proba(sequence - center), dtype=np.float64)


class _LeftToRight(hmm.GaussianHMM):  # type: ignore[misc]  # hmmlearn has no types
    """hmmlearn's model with diagonal covariances, which starts from `start`.

    floor: (D,) or a scalar, the smallest variance. options: those of hmmlearn.
    """

    means_: FloatArray
    _covars_: FloatArray

    def __init__(self, start: GaussianHMM, floor: FloatArray | float = 0.0, **options: Any) -> None:
        options = {"implementation": "scaling", **options}
        super().__init__(
            start.states,
            covariance_type="diag",
            covars_prior=0.0,
            covars_weight=1.0,
            transmat_prior=np.where(start.transitions > 0, TRANSITION_PRIOR, 1.0),
            params="tmc",  # a model always begins in its first state
            init_params="",
            **options,
        )
        self.floor = floor
        self.startprob_ = np.eye(start.states)[0]
        self.transmat_ = start.transitions
        self.means_ = start.means
        self.covars_ = start.variances

    def _compute_log_likelihood(self, X: FloatArray) -> FloatArray:
        # hmmlearn's own makes an array (T, K, D): a gigabyte for half an hour of motion
        return log_emissions(X, self.means_, self._covars_)

    def _do_mstep(self, stats: dict[str, FloatArray]) -> None:
        # Every state is visited, since none can be skipped: nothing is divided by zero.
        super()._do_mstep(stats)
        self._covars_ = np.maximum(self._covars_, self.floor)

    def _generate_sample_from_state(
        self, state: int, random_state: np.random.RandomState
    ) -> FloatArray:
        # hmmlearn's own decomposes a full covariance for each frame
        spread = np.sqrt(self._covars_[state])
        return np.asarray(random_state.normal(self.means_[state], spread))

    def model(self) -> GaussianHMM:
        """The fitted model."""
        return GaussianHMM(self.transmat_, self.means_, self._covars_)


def _improve(
    start: GaussianHMM, data: FloatArray, floor: FloatArray, iterations: int
) -> GaussianHMM:
    """The model after at most `iterations` iterations of EM from `start`.

    data: (T, D). floor: (D,) the smallest variances.
    """
    limits = {"n_iter": iterations, "tol": MIN_GAIN * len(data)}
    learner = _LeftToRight(start, floor, **limits)
    try:
        # Plain probabilities are fast. If a frame is far from every state, they become 0, or
        # the factors that scale them overflow.
        with np.errstate(over="raise", invalid="raise"):
            learner.fit(data)
    except (ValueError, FloatingPointError):
        learner = _LeftToRight(start, floor, implementation="log", **limits)
        learner.fit(data)
    return learner.model()


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
