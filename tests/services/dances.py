"""Dances as clips of a library."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from tests.cyclic_dances import CyclicDance
from tests.formats.npz.files import npz


def dance_file(dance: CyclicDance) -> bytes:
    """The dance as an NPZ file."""
    return npz(
        compressed=True,
        positions=dance.positions.astype(np.float32),
        joint_names=np.array([role.value for role in SUN_ROLES]),
        parents=np.array(SUN_PARENTS),
        frame_rate=dance.rate,
        unit="m",
        up_axis="y",
    )


def upload_dance(
    lib: Library, dance: CyclicDance, name: str = "dance.npz", **fields: Any
) -> ClipRecord:
    """Upload the dance, and queue its analysis."""
    return clips.create_clip(lib, io.BytesIO(dance_file(dance)), name, fields).clip
