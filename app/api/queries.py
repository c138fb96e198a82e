"""A query motion: a stored clip, or an uploaded file that is never stored."""

from __future__ import annotations

from collections.abc import Mapping
from typing import BinaryIO

from starlette.datastructures import UploadFile

from app.api.schemas.query_source import QueryForm
from app.errors import BadField
from app.kinedex_error import Place
from app.services.find.query_source import QuerySource

QUERY_FILES = {
    "file": "The query motion, in any format that an upload may have. It is never stored.",
    "skeleton": "The ASF file that an AMC file needs.",
}


def source_of(form: QueryForm, uploads: Mapping[str, UploadFile]) -> QuerySource:
    """Return the query of a form and its files.

    Raises BadField if both `clip_id` and `file` were sent, or neither.
    """
    if (form.clip_id is None) == ("file" not in uploads):
        message = "Send exactly one of clip_id and file."
        raise BadField(
            message, places=[Place("body.clip_id", message), Place("body.file", message)]
        )
    return form.source(content=file_of(uploads, "file"), skeleton=file_of(uploads, "skeleton"))


def file_of(uploads: Mapping[str, UploadFile], name: str) -> BinaryIO | None:
    """Return the file of a form as a stream of bytes, or None if it was not sent."""
    return uploads[name].file if name in uploads else None
