"""Opaque identifiers and the store's clock."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime

ID_BYTES = 10


def new_id(noun: str) -> str:
    """A random id (80 bits) that begins with the noun, such as `clip_5f0c...`."""
    return f"{noun}_{secrets.token_hex(ID_BYTES)}"


def share_before(row_id: str) -> float:
    """Return the share of all possible ids that are smaller than a random id: above 0, at most 1.

    The id must be from `new_id`. Raises ValueError otherwise.
    """
    return (int(row_id.rpartition("_")[2], 16) + 1) / 16.0 ** (2 * ID_BYTES)


def utc_now() -> datetime:
    """The current time in UTC, with a time zone."""
    return datetime.now(UTC)
