"""Fused distances of all vectors at once; the search measures them in parts."""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.example.fusion import Neighborhood


def fused_distances(query: FloatArray, vectors: FloatArray, warped: FloatArray) -> FloatArray:
    """(n,) fused distances of motion vectors (n, d) to a query (d,); warped: (n,) by DTW."""
    return Neighborhood.of(query, vectors).seen_from(0).distances(np.arange(len(vectors)), warped)
