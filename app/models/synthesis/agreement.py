"""Whether takes of a task are the same motion, so that their mean is one, too.

Two bows are a bow; the mean of two dances is a body that trembles on the spot. Where takes do
not agree one of them is followed.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS
from app.models.synthesis.basis import weights
from app.numerics.arrays import FloatArray

AGREED = 0.5
"""Share of their movement that takes must have in common: most. Aligned, one person's takes of a
gesture have .8 to 1.0, different persons' .6 to .95; unlike dances .0 to .3, and gestures that are
another one by each person (the *bye* of eight moods) .1. From .35 to .5 hits on new tasks differ by
.03 at most."""


def agree(agreement: float | None) -> bool:
    """Whether takes are the same motion; None, of a single one, is."""
    return agreement is None or agreement >= AGREED


def agreement(shapes: FloatArray) -> float:
    """Share (at most 1.0, about 0.0 for motions that have nothing to do with each other) of the
    movement in motion shapes (n, 1378) that they have in common; 1.0 for a single one.

    Movement is what is not posture: each channel beside its mean over the 32 moments. What n
    motions have in common is estimated by their inner products with each other, not themselves,
    so that it does not depend on n.
    """
    if len(shapes) < 2:
        return 1.0
    moments = np.asarray(shapes[:, :-2], dtype=np.float64).reshape(-1, SAMPLES, CHANNELS)
    moving = (moments - moments.mean(axis=1, keepdims=True)) * weights()[:CHANNELS]
    own = float((moving**2).sum())
    pairs = float((moving.sum(axis=0) ** 2).sum()) - own
    return min(pairs / max((len(shapes) - 1) * own, 1e-12), 1.0) if own > 1e-12 else 1.0
