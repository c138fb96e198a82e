"""hmmlearn as the reference of our left-to-right models, and sequences to try both on."""

from __future__ import annotations

import numpy as np
from hmmlearn import hmm

from app.numerics.hmm import GaussianHMM
from app.numerics.hmm_fit import TRANSITION_PRIOR


class FlooredHMM(hmm.GaussianHMM):
    """hmmlearn's model with a variance floor inside the M-step (its min_covar is none)."""

    floor: np.ndarray

    def _do_mstep(self, stats: dict) -> None:
        super()._do_mstep(stats)
        self._covars_ = np.maximum(self._covars_, self.floor)


def as_hmmlearn(model: GaussianHMM, floor: np.ndarray, iterations: int = 0) -> FlooredHMM:
    states = model.states
    other = FlooredHMM(
        states,
        covariance_type="diag",
        init_params="",
        params="mct",
        n_iter=iterations,
        tol=-np.inf,
        covars_prior=0.0,
        covars_weight=1.0,
        transmat_prior=np.where(model.transitions > 0, TRANSITION_PRIOR, 1.0),
    )
    other.floor = floor
    other.startprob_ = np.eye(states)[0]
    other.transmat_ = model.transitions
    other.means_ = model.means
    other.covars_ = model.variances
    return other


def wavy(frames: int, seed: int, channels: int = 6) -> np.ndarray:
    """(frames, channels): sums of a slow wave, a place and a little noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(frames)[:, None] / 30.0
    waves = np.sin(2 * np.pi * rng.uniform(0.2, 1.5, channels) * t + rng.uniform(0, 6, channels))
    waves = waves * rng.uniform(0.2, 1.5, channels) + rng.normal(size=channels)
    return waves + rng.normal(size=(frames, channels)) * 0.05
