"""Positions as an NPZ file in the layout that `npz` documents and reads."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray, IntArray


def write_npz(
    names: Sequence[str], parents: IntArray, positions: FloatArray, frame_rate: float
) -> bytes:
    """An NPZ file of positions (frames, joints, 3) in meters, Y up; the same bytes each time."""
    file = io.BytesIO()
    np.savez(
        file,
        allow_pickle=False,
        positions=np.asarray(positions, dtype="<f4"),
        joint_names=np.array(names, dtype=np.str_),
        parents=np.asarray(parents, dtype="<i4"),
        frame_rate=np.float64(frame_rate),
        unit=np.str_("m"),
        up_axis=np.str_("y"),
    )
    return file.getvalue()
