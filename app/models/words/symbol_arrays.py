"""Stores many symbols in a few arrays, for records that hold symbols (without pickle)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from app.numerics.hmm.model import GaussianHMM


def pack_symbols(symbols: Sequence[GaussianHMM]) -> dict[str, np.ndarray[Any, Any]]:
    """Arrays of N >= 1 symbols.

    states: (N,) numbers of states K; means, variances: (sum K, D) and stay: (sum K,), the
    states of all symbols in a row.
    """
    return {
        "states": np.array([symbol.states for symbol in symbols], dtype=np.int64),
        "means": np.concatenate([symbol.means for symbol in symbols]),
        "variances": np.concatenate([symbol.variances for symbol in symbols]),
        "stay": np.concatenate([np.diagonal(symbol.transitions) for symbol in symbols]),
    }


def unpack_symbols(arrays: Mapping[str, np.ndarray[Any, Any]]) -> tuple[GaussianHMM, ...]:
    """The symbols from the result of `pack_symbols`."""
    cuts = np.cumsum(arrays["states"])[:-1]
    parts = (np.split(arrays[name], cuts) for name in ("stay", "means", "variances"))
    return tuple(
        GaussianHMM(np.diag(stay) + np.diag(1.0 - stay[:-1], 1), means, variances)
        for stay, means, variances in zip(*parts, strict=True)
    )
