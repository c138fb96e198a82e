"""Answers: session. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record
from kinedex.types.choices import KeyRole


@dataclass(frozen=True, slots=True)
class Session(Record):
    """What the caller may do.

    keys_needed: Whether this service asks for API keys.
    role: Of the caller's valid key; null without one. Where no keys are needed, everything is
    allowed.
    """

    keys_needed: bool
    role: KeyRole | None
