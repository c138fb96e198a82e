"""A digest of what a call sends: the same for each repetition of the call.

A client that sends a form again chooses another boundary between its fields. So the boundary does
not count.
"""

from __future__ import annotations

import hashlib
import re

from starlette.datastructures import Headers

from app.api.guard.media import FORM, media_type

_BOUNDARY = re.compile(r'boundary="?([^";,]+)"?', re.IGNORECASE)


class ContentDigest:
    """SHA-256 of a body that arrives in pieces, and of its media type."""

    def __init__(self, headers: Headers) -> None:
        kind = media_type(headers)
        self._hash = hashlib.sha256(kind.encode() + b"\n")
        found = _BOUNDARY.search(headers.get("content-type", "")) if kind == FORM else None
        self._boundary = found[1].encode("latin-1") if found else b""
        self._held = b""

    def update(self, piece: bytes) -> None:
        """Add the next piece of the body."""
        if not self._boundary:
            self._hash.update(piece)
            return
        # The end of a piece may be the beginning of a boundary.
        parts = (self._held + piece).split(self._boundary)
        for part in parts[:-1]:
            self._hash.update(part + b"\0boundary\0")
        last, kept = parts[-1], len(self._boundary) - 1
        cut = max(len(last) - kept, 0)
        self._hash.update(last[:cut])
        self._held = last[cut:]

    def hexdigest(self) -> str:
        """Return the digest of everything so far."""
        whole = self._hash.copy()
        whole.update(self._held)
        return whole.hexdigest()
