"""A query motion: a stored clip, or an uploaded file that is never stored."""

from __future__ import annotations

from collections.abc import Mapping
from typing import BinaryIO

from starlette.datastructures import UploadFile

from app.errors import BadField, Place

QUERY_FILES = {
    "file": "The query motion: BVH, AMC, C3D, FBX, NPZ or NPY. It is never stored.",
    "skeleton": "The ASF file that an AMC file needs.",
}


def exactly_one(clip_id: str | None, uploads: Mapping[str, UploadFile]) -> None:
    """Refuse a form with both, or neither, of `clip_id` and `file`. Raises BadField."""
    if (clip_id is None) == ("file" not in uploads):
        message = "Send exactly one of clip_id and file."
        raise BadField(
            message, places=[Place("body.clip_id", message), Place("body.file", message)]
        )


def file_of(uploads: Mapping[str, UploadFile], name: str) -> BinaryIO | None:
    """The bytes of a form's file, where it came."""
    return uploads[name].file if name in uploads else None
