"""Calls: segments. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, record

if TYPE_CHECKING:
    from kinedex.types.segments import SegmentList


def get_segments(clip_id: str) -> Call[SegmentList]:
    """The motions from each keypose to the next, and the sequences of them that repeat.

    If a person named keyposes, they replace the keyposes that Kinedex finds. Search segments
    with `POST /v1/search/motion` and `"scope": "segments"`, with `segment` or any part of a
    clip.
    """
    from kinedex.types.segments import SegmentList

    return Call(
        "get_segments",
        "GET",
        path_of("/v1/clips/{clip_id}/segments", clip_id=clip_id),
        record(SegmentList),
    )
