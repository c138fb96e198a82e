"""Opaque identifiers and the store's clock."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime

ID_BYTES = 10


def new_id(noun: str) -> str:
    """A random id that tells what it names, such as `clip_5f0c...` (80 bits)."""
    return f"{noun}_{secrets.token_hex(ID_BYTES)}"


def utc_now() -> datetime:
    """This moment, aware, in UTC."""
    return datetime.now(UTC)
