"""Calls: keyposes. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.keyposes import Keyposes, KeyposesNamed


def get_keyposes(
    clip_id: str,
    *,
    method: Literal["rms", "printed"] | None = None,
    weights: Literal["uniform", "mass"] | None = None,
    t1: float | None = None,
    t2: float | None = None,
) -> Call[Keyposes]:
    """Beats, keyposes and energy curves (Perera 2009, section 3), and the keyposes that a person
    named.

    Near each known beat (given, from a tempo or from a recording), the minimum of the energy is
    a keypose if it is below `t1`, or more than `t2` below the maxima on its two sides. The
    global energy is tried first, then the local energy. Without known beats, every rest of the
    body is tested in this way. `t1` and `t2` are shares of the median local maximum of each
    curve, so that they fit calm and wild motions. Without them, the thresholds are those of the
    clip's segments and low-dimensional motions: learned from the annotated clips of this
    library, or else the defaults. When a fit learns other thresholds, all clips are analyzed
    again; each has its old keyposes until then, everywhere. A motion without rests has its
    keyposes where it is slowest relative to the waist, as in the steps of a walk.

    method: RMS of joint speeds, or equations 1 and 2 as printed. Default: rms.
    weights: Weights of the joints: all equal, or the mass that moves with each (fig. 6).
        Default: uniform.
    t1: A minimum below this share of the median local maximum is a rest.
    t2: A drop by more than this share of the median local maximum is a rest.
    """
    from kinedex.types.keyposes import Keyposes

    return Call(
        "get_keyposes",
        "GET",
        path_of("/v1/clips/{clip_id}/keyposes", clip_id=clip_id),
        record(Keyposes),
        query=given(method=method, weights=weights, t1=t1, t2=t2),
    )


def name_keyposes(clip_id: str, times: Sequence[float]) -> Call[KeyposesNamed]:
    """Name the times of the clip's keyposes. Its segments, its low-dimensional motions and the
    thresholds of the next fit then use these keyposes. `GET` shows them beside the keyposes that
    Kinedex finds.

    times: Seconds from the start of the clip, in any order.
    """
    from kinedex.types.keyposes import KeyposesNamed

    return Call(
        "name_keyposes",
        "PUT",
        path_of("/v1/clips/{clip_id}/keyposes", clip_id=clip_id),
        record(KeyposesNamed),
        json=given(times=times),
    )


def forget_named_keyposes(clip_id: str) -> Call[None]:
    """Delete the named keyposes. Then the keyposes that Kinedex finds are used again."""
    return Call(
        "forget_named_keyposes",
        "DELETE",
        path_of("/v1/clips/{clip_id}/keyposes", clip_id=clip_id),
        nothing,
    )
