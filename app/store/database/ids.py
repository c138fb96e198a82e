"""Opaque identifiers and the store's clock."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime

ID_BYTES = 10


def new_id(noun: str) -> str:
    """A random id (80 bits) that begins with the noun, such as `clip_5f0c...`."""
    return f"{noun}_{secrets.token_hex(ID_BYTES)}"


def utc_now() -> datetime:
    """The current time in UTC, with a time zone."""
    return datetime.now(UTC)
