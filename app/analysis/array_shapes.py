"""The shapes of the arrays that an analysis stores, by name.

Clips keep the arrays of an earlier version of the analysis until they are analyzed again. Code
that compares clips first asks here whether an array has the shape that this version uses.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

SHAPES: Mapping[str, tuple[int | None, ...]] = {
    "role_positions": (None, 13, 3),
    "features_10hz": (None, 82),
    "active_span": (2,),
    "motion_vector": (128,),
    "paced_vector": (128,),
    "wide_motion_vector": (512,),
    "msv_lambda": (1,),
    "msv_rho": (13,),
    "msv_epsilon": (None,),
    "msv_convergence": (None, 2),
    "motion_sample": (1250,),
    "angle_sample": (642,),
    "motion_shape": (1378,),
    "symbol_statistics": (131,),
    "movement_signs": (44,),
    "window_vectors_1s": (None, 125),
    "window_spans_1s": (None, 2),
    "window_vectors_2s": (None, 125),
    "window_spans_2s": (None, 2),
    "window_vectors_4s": (None, 125),
    "window_spans_4s": (None, 2),
    "word_windows": (None, 175),
    "word_window_spans": (None, 2),
    "symbol_means": (None, 26),
    "symbol_variances": (None, 26),
    "symbol_transitions": (None, None),
    "beat_times": (None,),
    "beat_facts": (3,),
    "moments": (None, 33),
    "pose_cover": (None, 38),
    "keypose_frames": (None,),
    "keypose_thresholds": (2,),
    "segment_spans": (None, 2),
    "segment_vectors": (None, 185),
    "segment_cycles": (None, 3),
}
"""The shape of each array. None stands for a size that differs from motion to motion."""


def is_usable(name: str, array: NDArray[Any]) -> bool:
    """Whether an array has the shape that this version expects; true for unknown names."""
    expected = SHAPES.get(name)
    if expected is None:
        return True
    return len(expected) == array.ndim and all(
        size in (None, found) for size, found in zip(expected, array.shape, strict=True)
    )
