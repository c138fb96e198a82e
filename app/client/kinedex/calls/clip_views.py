"""Calls: clip views. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from kinedex.call import OCTETS, Call, path_of, record, text
from kinedex.positions import Positions, positions
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.views import Descriptor, Motion


def get_motion(
    clip_id: str, *, fps: float | None = None, joints: Literal["all", "roles"] | None = None
) -> Call[Motion]:
    """Joint positions: JSON, or little-endian float32 for `Accept: application/octet-stream`.

    fps: The motion is resampled to this rate. Default: the clip's own rate.
    joints: All joints, or the 13 joints of figure 2 in Sun 2011, in its order. Default: all.
    """
    from kinedex.types.views import Motion

    return Call(
        "get_motion",
        "GET",
        path_of("/v1/clips/{clip_id}/motion", clip_id=clip_id),
        record(Motion),
        query=given(fps=fps, joints=joints),
    )


def get_motion_array(
    clip_id: str, *, fps: float | None = None, joints: Literal["all", "roles"] | None = None
) -> Call[Positions]:
    """Joint positions: JSON, or little-endian float32 for `Accept: application/octet-stream`. The
    answer is an array.

    fps: The motion is resampled to this rate. Default: the clip's own rate.
    joints: All joints, or the 13 joints of figure 2 in Sun 2011, in its order. Default: all.
    """
    return Call(
        "get_motion",
        "GET",
        path_of("/v1/clips/{clip_id}/motion", clip_id=clip_id),
        positions,
        query=given(fps=fps, joints=joints),
        accept=OCTETS,
    )


def get_descriptor(clip_id: str) -> Call[Descriptor]:
    """The arrays by which the clip is compared with others."""
    from kinedex.types.views import Descriptor

    return Call(
        "get_descriptor",
        "GET",
        path_of("/v1/clips/{clip_id}/descriptor", clip_id=clip_id),
        record(Descriptor),
    )


def get_thumbnail(clip_id: str) -> Call[str]:
    """The clip as a small picture."""
    return Call(
        "get_thumbnail",
        "GET",
        path_of("/v1/clips/{clip_id}/thumbnail.svg", clip_id=clip_id),
        text,
        accept="*/*",
    )


def get_self_similarity(
    clip_id: str, *, q: int | None = None, eta: float | None = None, time: float | None = None
) -> Call[str]:
    """The self-similarity matrix of one pose: the distances between its joints.

    Figure 3 of Sun 2011. Distances are in body lengths; the darkest cell is the largest distance
    of the clip.

    q: The norm of the distances, 1 or 2. Default: 2.
    eta: Above 0: a cell is dark where two joints are at most this many body lengths apart. 0:
        the darker, the farther apart. Default: 0.0.
    time: Seconds: the moment of the matrix. Default: the middle of the active part.
    """
    return Call(
        "get_self_similarity",
        "GET",
        path_of("/v1/clips/{clip_id}/ssm.svg", clip_id=clip_id),
        text,
        query=given(q=q, eta=eta, time=time),
        accept="*/*",
    )


def get_motion_volume(
    clip_id: str, *, q: int | None = None, eta: float | None = None, slices: int | None = None
) -> Call[str]:
    """The motion volume: the self-similarity matrices of the clip over time.

    Figure 5 of Sun 2011.

    q: The norm of the distances, 1 or 2. Default: 2.
    eta: Above 0: a cell is dark where two joints are at most this many body lengths apart. 0:
        the darker, the farther apart. Default: 0.0.
    slices: Number of slices, evenly over the active part. Default: 10.
    """
    return Call(
        "get_motion_volume",
        "GET",
        path_of("/v1/clips/{clip_id}/msv.svg", clip_id=clip_id),
        text,
        query=given(q=q, eta=eta, slices=slices),
        accept="*/*",
    )
