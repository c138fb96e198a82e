"""Parses JSON within limits."""

from __future__ import annotations

import json
from typing import Any

from app.formats.common.failures import too_large, unreadable_at

MAX_JSON_BYTES = 64_000_000
"""The longest text that is parsed. It needs about ten times as much memory."""
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def parse_json(text: bytes) -> Any:
    """The value of a text in JSON. Raises Unreadable, and TooLarge."""
    if len(text) > MAX_JSON_BYTES:
        raise too_large("JSON", f"expected at most {MAX_JSON_BYTES} bytes")
    try:
        return json.loads(text.removeprefix(_BYTE_ORDER_MARK))
    # A deep nesting ends the recursion of the parser.
    except (ValueError, RecursionError) as error:
        raise unreadable_at("JSON", f"expected a value in JSON ({error!s:.80})") from None
