"""The motion symbol of a clip: a left-to-right HMM of its 26 channels (Takano, section 2.1)."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM

SYMBOL_STATES = 30
"""The states of a symbol (Takano, section 3). Clips under three seconds have fewer."""

VARIANCE_FLOOR = 0.1
"""The smallest variance of a state, as a share of the channel's typical variance (1, scaled)."""

SYMBOL_ARRAYS = ("symbol_transitions", "symbol_means", "symbol_variances")
"""The stored arrays that make a symbol."""


def motion_symbol(features: FloatArray) -> GaussianHMM:
    """The symbol of the channels `features` (n, 26), n >= 1, from `symbol_features`.

    The result is deterministic. Raises ValueError if a value is not finite.
    """
    from app.numerics.hmm.fit import fit_left_to_right  # only processes that fit load hmmlearn

    floor = np.full(features.shape[1], VARIANCE_FLOOR)
    return fit_left_to_right(features, states=SYMBOL_STATES, variance_floor=floor)


def describe_symbol(features: FloatArray) -> dict[str, FloatArray]:
    """The arrays, by name, that are stored for the symbol of `features` (n, 26), float32.

    symbol_means, symbol_variances: (K, 26). symbol_transitions: (K, K).
    """
    symbol = motion_symbol(features)
    return {
        "symbol_means": symbol.means.astype(np.float32),
        "symbol_variances": symbol.variances.astype(np.float32),
        "symbol_transitions": symbol.transitions.astype(np.float32),
    }


def symbol_from_arrays(arrays: dict[str, FloatArray]) -> GaussianHMM:
    """The symbol, in float64, from the arrays of `describe_symbol`."""
    return GaussianHMM(
        transitions=arrays["symbol_transitions"].astype(np.float64),
        means=arrays["symbol_means"].astype(np.float64),
        variances=arrays["symbol_variances"].astype(np.float64),
    )
