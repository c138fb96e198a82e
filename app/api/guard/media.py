"""The media type of a request's body."""

from __future__ import annotations

from collections.abc import Mapping

FORM = "multipart/form-data"


def media_type(headers: Mapping[str, str]) -> str:
    """Return the body's media type in lower case without parameters, "" if there is none."""
    return headers.get("content-type", "").partition(";")[0].strip().lower()


def is_json(kind: str) -> bool:
    """Whether a media type is JSON."""
    return kind == "application/json" or (
        kind.startswith("application/") and kind.endswith("+json")
    )
