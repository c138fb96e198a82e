"""Which symbol of a library an observed motion is likeliest of (Takano, section 2.4).

The likelihood of a motion under every symbol of a library of 500 costs .2 s, so only the NEAREST
by divergence from the motion's own symbol are asked. On 501 real clips, among symbols of other
recordings, the likeliest of all was the very nearest for 72 %, among the 20 nearest for 95.8 %,
among 60 for 96.8 %. Through it no more is recognized than through the nearest: the two share a
word in 90.0 and 91.6 %, the task in 84.8 and 87.8 %.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM, log_likelihoods

NEAREST = 20
_UNASKED = -1e30
"""Below every likelihood; less a divergence, so that the unasked stay in order too."""


def likelihoods_of_symbols(
    symbols: Sequence[GaussianHMM],
    distances: FloatArray,
    sequence: Callable[[int], FloatArray],
    nearest: int = NEAREST,
) -> FloatArray:
    """(N, N) log P(motion i | symbol j) of the N motions that the symbols were made of.

    distances: (N, N) of the symbols, with _UNASKED less their multiple where the likelihood was
    not computed; sequence: the channels (T, D) of a motion.
    """
    found = _UNASKED * (1.0 + np.asarray(distances, dtype=np.float64))
    for row in range(len(symbols)):
        near = np.argsort(distances[row], kind="stable")[:nearest]
        found[row, near] = log_likelihoods([symbols[i] for i in near], sequence(row))
    return found
