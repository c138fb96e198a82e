"""Clips of a few made-up motions with words, some of them said in two ways."""

from __future__ import annotations

import numpy as np

from app.analysis.symbols.channels import symbol_statistics
from app.numerics.hmm.fit import fit_left_to_right
from app.numerics.hmm.model import GaussianHMM
from tests.numerics.hmm_reference import wavy

KINDS = (("walk", "stroll"), ("run", "jog"), ("wave", "wave"), ("bow", "greet"))


def word_clips(
    takes: int, seed: int = 0
) -> tuple[list[GaussianHMM], np.ndarray, list[tuple[str, ...]]]:
    """Symbols, statistics (N, 131) and words of `takes` takes of each of KINDS."""
    rng = np.random.default_rng(seed)
    symbols, statistics, words = [], [], []
    for take in range(takes):
        for kind, names in enumerate(KINDS):
            features = wavy(50 + 5 * (take % 3), 100 + kind, channels=26)
            features = features + rng.normal(size=26) * 0.2 + rng.normal(size=features.shape) * 0.1
            symbols.append(fit_left_to_right(features, states=8, variance_floor=np.full(26, 0.1)))
            statistics.append(symbol_statistics(features, 30.0))
            words.append((names[take % 2],))
    return symbols, np.array(statistics), words
