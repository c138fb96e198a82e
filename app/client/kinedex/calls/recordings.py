"""Calls: recordings. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, read_bytes, record

if TYPE_CHECKING:
    from kinedex.types.clips import Clip


def get_audio(clip_id: str) -> Call[bytes]:
    """The recording that goes with a clip, as an attachment."""
    return Call(
        "get_audio",
        "GET",
        path_of("/v1/clips/{clip_id}/audio", clip_id=clip_id),
        read_bytes,
        accept="*/*",
    )


def delete_audio(clip_id: str) -> Call[Clip]:
    """Delete the recording that goes with a clip. The clip is analyzed again."""
    from kinedex.types.clips import Clip

    return Call(
        "delete_audio",
        "DELETE",
        path_of("/v1/clips/{clip_id}/audio", clip_id=clip_id),
        record(Clip),
    )
