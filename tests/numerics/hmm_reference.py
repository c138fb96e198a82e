"""Expectation-maximization as a textbook has it, frame by frame, and sequences to try it on."""

from __future__ import annotations

import numpy as np

from app.numerics.hmm.fit import TRANSITION_PRIOR
from app.numerics.hmm.model import GaussianHMM, log_emissions


def naive_forward(emissions: np.ndarray, transitions: np.ndarray) -> np.ndarray:
    """(T, K) log alpha: Rabiner 1989, eq. 19-20; the model begins in its first state."""
    alpha = np.full(emissions.shape, -np.inf)
    alpha[0, 0] = emissions[0, 0]
    for t in range(1, len(emissions)):
        arrived = np.logaddexp.reduce(alpha[t - 1][:, None] + _log(transitions))
        alpha[t] = emissions[t] + arrived
    return alpha


def naive_occupancy(model: GaussianHMM, data: np.ndarray) -> np.ndarray:
    """(T, K) probability of each state at each frame."""
    emissions = log_emissions(data, model.means, model.variances)
    joint = naive_forward(emissions, model.transitions) + _backward(emissions, model.transitions)
    return np.exp(joint - np.logaddexp.reduce(joint, axis=1)[:, None])


def textbook_em(
    start: GaussianHMM, data: np.ndarray, floor: np.ndarray, iterations: int
) -> GaussianHMM:
    """`start` after so many iterations, with a floor and a prior on the allowed transitions."""
    model = start
    for _ in range(iterations):
        emissions = log_emissions(data, model.means, model.variances)
        alpha = naive_forward(emissions, model.transitions)
        beta = _backward(emissions, model.transitions)
        total = np.logaddexp.reduce(alpha[-1])
        # (T - 1, K, K): the probability of each transition after each frame but the last
        ahead = (emissions + beta)[1:, None, :] + _log(model.transitions)
        counts = np.exp(alpha[:-1, :, None] + ahead - total).sum(axis=0)
        counts += np.where(model.transitions > 0, TRANSITION_PRIOR - 1, 0)
        weights = np.exp(alpha + beta - total)
        frames = weights.sum(axis=0)[:, None]
        means = weights.T @ data / frames
        apart = (data[:, None] - means) ** 2  # (T, K, D)
        variances = np.einsum("tk,tkd->kd", weights, apart) / frames
        model = GaussianHMM(
            counts / counts.sum(axis=1, keepdims=True), means, np.maximum(variances, floor)
        )
    return model


def wavy(frames: int, seed: int, channels: int = 6) -> np.ndarray:
    """(frames, channels): sums of a slow wave, a place and a little noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(frames)[:, None] / 30.0
    waves = np.sin(2 * np.pi * rng.uniform(0.2, 1.5, channels) * t + rng.uniform(0, 6, channels))
    waves = waves * rng.uniform(0.2, 1.5, channels) + rng.normal(size=channels)
    return waves + rng.normal(size=(frames, channels)) * 0.05


def _backward(emissions: np.ndarray, transitions: np.ndarray) -> np.ndarray:
    beta = np.zeros(emissions.shape)
    for t in range(len(emissions) - 2, -1, -1):
        beta[t] = np.logaddexp.reduce(_log(transitions) + emissions[t + 1] + beta[t + 1], axis=1)
    return beta


def _log(transitions: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return np.log(transitions)
