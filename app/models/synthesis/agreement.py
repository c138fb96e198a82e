"""Whether takes of a task are similar enough for their mean to be a motion.

The mean of two bows is a bow. The mean of two different dances is a body that trembles on the
spot. So if takes do not agree, synthesis follows one of them.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS
from app.models.synthesis.basis import weights
from app.numerics.arrays import FloatArray

MIN_AGREEMENT = 0.5
"""The smallest share of their movement that takes must have in common. Measured after alignment:
takes of a gesture by one person .8 to 1.0, by different persons .6 to .95; different dances .0 to
.3; gestures that each person does in another way (the *bye* of eight moods) .1. With limits from
.35 to .5, the hits on new tasks differ by at most .03."""


def agree(agreement: float | None) -> bool:
    """Whether takes with this agreement (see `agreement`) are the same motion.

    None is the agreement of a single take, which agrees with itself.
    """
    return agreement is None or agreement >= MIN_AGREEMENT


def agreement(shapes: FloatArray) -> float:
    """The share of their movement that motion shapes (n, 1378) have in common.

    It is at most 1.0, about 0.0 for unrelated motions, and 1.0 for a single motion. Movement is
    each channel minus its mean over the 32 moments (the posture). The common part of n motions
    is estimated from the inner products of different motions only, so that it does not depend
    on n.
    """
    if len(shapes) < 2:
        return 1.0
    moments = np.asarray(shapes[:, :-2], dtype=np.float64).reshape(-1, SAMPLES, CHANNELS)
    movement = (moments - moments.mean(axis=1, keepdims=True)) * weights()[:CHANNELS]
    own = float((movement**2).sum())
    # |sum of all|^2 has all inner products; `own` are those of a motion with itself
    pairs = float((movement.sum(axis=0) ** 2).sum()) - own
    return min(pairs / max((len(shapes) - 1) * own, 1e-12), 1.0) if own > 1e-12 else 1.0
