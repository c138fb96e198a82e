"""Answers: session. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from kinedex.records import Record
from kinedex.types.choices import KeyRole


@dataclass(frozen=True, slots=True)
class Session(Record):
    """What the caller may do.

    keys_needed: Whether this service asks for API keys.
    role: Of the caller's valid key; null without one. Where no keys are needed, everything is
    allowed.
    source: The only source whose clips the key may read; null: all clips.
    expires_at: When the key expires; null: never.
    """

    keys_needed: bool
    role: KeyRole | None
    source: str | None
    expires_at: datetime | None
