"""Calls: alignment. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.alignment import Alignment


def get_alignment(
    clip_id: str,
    other: str,
    *,
    start: float | None = None,
    end: float | None = None,
    other_start: float | None = None,
    other_end: float | None = None,
) -> Call[Alignment]:
    """How the clip differs from another: which joints, when, and by how many centimeters.

    Dynamic time warping finds the moments that belong together, ten times a second, however fast
    each of the two moves. The differences do not depend on place, heading and size of the
    bodies. Each part may be up to 300 s long.

    other: Id of the second clip. It may be the same clip, with another part.
    start: Start of the part of the first clip, seconds.
    end: End of the part of the first clip, seconds.
    other_start: The same for the second clip.
    other_end: The same for the second clip.
    """
    from kinedex.types.alignment import Alignment

    return Call(
        "get_alignment",
        "GET",
        path_of("/v1/clips/{clip_id}/alignment", clip_id=clip_id),
        record(Alignment),
        query=given(
            other=other, start=start, end=end, other_start=other_start, other_end=other_end
        ),
    )
