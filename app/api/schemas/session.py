"""Signing in with a browser."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing
from app.store.key_role import KeyRole


class SignIn(Incoming):
    """The key to sign in with."""

    key: str = Field(max_length=200, description="An API key.", examples=["API_KEY"])


class Session(Outgoing):
    """What the caller may do."""

    keys_needed: bool = Field(description="Whether this service asks for API keys.")
    role: KeyRole | None = Field(
        description="Of the caller's valid key; null without one. Where no keys are needed, "
        "everything is allowed."
    )
    source: str | None = Field(
        description="The only source whose clips the key may read; null: all clips."
    )
    expires_at: datetime | None = Field(description="When the key expires; null: never.")
