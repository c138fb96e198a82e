"""Sequences drawn from left-to-right models, and the states of given sequences, by hmmlearn.

hmmlearn takes a second and 35 MB to load. So import this module inside the function that needs it.
Shapes: frames T, states K, channels D.
"""

from __future__ import annotations

import numpy as np
from hmmlearn import hmm

from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM, log_emissions


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
    return np.asarray(_LeftToRight(centered).predict_proba(sequence - center), dtype=np.float64)


class _LeftToRight(hmm.GaussianHMM):  # type: ignore[misc]  # hmmlearn has no types
    """`model` as one of hmmlearn's, with diagonal covariances."""

    means_: FloatArray
    _covars_: FloatArray

    def __init__(self, model: GaussianHMM) -> None:
        # logarithms: under a model of other motion, plain probabilities underflow
        super().__init__(model.states, covariance_type="diag", init_params="", implementation="log")
        self.startprob_ = np.eye(model.states)[0]
        self.transmat_ = model.transitions
        self.means_ = model.means
        self.covars_ = model.variances

    def _compute_log_likelihood(self, X: FloatArray) -> FloatArray:
        # hmmlearn's own makes an array (T, K, D): a gigabyte for half an hour of motion
        return log_emissions(X, self.means_, self._covars_)

    def _generate_sample_from_state(
        self, state: int, random_state: np.random.RandomState
    ) -> FloatArray:
        # hmmlearn's own decomposes a full covariance for each frame
        spread = np.sqrt(self._covars_[state])
        return np.asarray(random_state.normal(self.means_[state], spread))
