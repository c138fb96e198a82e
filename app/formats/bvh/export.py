"""An animation as a BVH file: Y up, and in centimeters unless said otherwise, as most programs
expect.

A joint that moves relative to its parent has position channels. A leaf without an end site gets
one, because other programs need it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from app.formats.bvh.writer import bvh_blocks
from app.formats.common.names import MAX_NAME_LENGTH
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.skeleton import Skeleton

UNITS_PER_METER = 100.0
"""BVH does not say its unit. Centimeters are usual; Blender takes the numbers for meters."""
ROTATION_ORDER = "ZXY"
END_SHARE = 0.5
"""The length of an added end site, as a share of the bone before it."""


def write_animation_bvh(
    animation: Animation, units_per_meter: float = UNITS_PER_METER
) -> Iterator[bytes]:
    """A BVH file of the animation, piece by piece."""
    skeleton = _scaled(_with_end_sites(animation.skeleton), units_per_meter)
    return bvh_blocks(
        replace(skeleton, names=tuple(bvh_name(name) for name in skeleton.names)),
        animation.rotations,
        animation.translations * units_per_meter,
        animation.frame_rate,
        ROTATION_ORDER,
        np.flatnonzero(animation.moving_joints()).tolist(),
    )


def bvh_name(name: str) -> str:
    """A name that BVH readers can read: on one line, printable, without braces."""
    plain = "".join(char if char.isprintable() and char not in "{}" else "_" for char in name)
    return " ".join(plain.split())[:MAX_NAME_LENGTH].strip() or "joint"


def _scaled(skeleton: Skeleton, by: float) -> Skeleton:
    return replace(
        skeleton,
        offsets=skeleton.offsets * by,
        end_offsets=skeleton.end_offsets * by,
    )


def _with_end_sites(skeleton: Skeleton) -> Skeleton:
    inner = {*skeleton.parents.tolist(), *skeleton.end_parents.tolist()}
    leaves = np.array([joint for joint in range(len(skeleton)) if joint not in inner], dtype=int)
    is_child = (skeleton.parents[leaves] >= 0)[:, None]
    ends = END_SHARE * np.where(is_child, skeleton.offsets[leaves], 0.0)
    return replace(
        skeleton,
        end_parents=np.concatenate([skeleton.end_parents, leaves]),
        end_offsets=np.concatenate([skeleton.end_offsets, ends]),
    )
