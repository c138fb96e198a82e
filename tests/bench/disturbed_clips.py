"""The real clips as stored and as disturbed, for the benches of disturbances."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from app.analysis.analyze import describe_for_search
from app.formats.read import read_recording
from app.models.recognition.disturbances import Disturb, faster, jitter, kept, noise
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.numerics.binomial import wilson_interval
from app.search.index.vector_index import PACED, VECTOR
from tests.bench.disturbances import repeated, waiting, without_first
from tests.real_clips import manifest, real_clips

POSITIONS = "role_positions"
ARRAYS = (
    VECTOR,
    PACED,
    "features_10hz",
    "active_span",
    "window_vectors_1s",
    POSITIONS,
    "motion_sample",
    "wide_motion_vector",
)
SEED = 7
DISTURBANCES: dict[str, Disturb] = {
    "as stored": kept(0.0, 1.0),
    "noise 3 mm": noise(3.0),
    "noise 5 mm": noise(5.0),
    "noise 10 mm": noise(10.0),
    "jitter .5 degrees": jitter(0.5),
    "jitter 1 degree": jitter(1.0),
    "1.2 times faster": faster(1.2),
    "1.5 times faster": faster(1.5),
    "1.5 times slower": faster(1 / 1.5),
    "2 times slower": faster(0.5),
    "30 % cut off": kept(0.15, 0.85),
    "middle half": kept(0.25, 0.75),
    "2 s idle before": waiting(2.0),
    "repeated": repeated,
    "first two frames lost": without_first(2),
}


@dataclass(frozen=True)
class Stored:
    """n clips with their labels, and their descriptors by name."""

    rows: list[dict[str, str]]
    motions: list[Motion]
    arrays: list[dict[str, np.ndarray]]

    def labels(self, name: str) -> np.ndarray:
        return np.array([row[name] for row in self.rows])


@lru_cache(maxsize=1)
def stored() -> Stored:
    rows = [row for row in manifest() if row["path"].endswith(".bvh")]
    motions = [
        canonicalize(
            read_recording((real_clips() / row["path"]).read_bytes()), frame_rate=float(row["fps"])
        )
        for row in rows
    ]
    return Stored(rows, motions, [described(motion) for motion in motions])


def described(motion: Motion) -> dict[str, np.ndarray]:
    return dict(describe_for_search(motion, ARRAYS).arrays)


def drawn(among: np.ndarray, count: int) -> np.ndarray:
    return np.random.RandomState(SEED).choice(among, count, replace=False)


def share(right: list[bool]) -> str:
    low, high = wilson_interval(sum(right), len(right))
    return f"{np.mean(right):.3f} ({low:.2f} to {high:.2f})"
