"""Health of the service: alive, ready."""

from __future__ import annotations

from typing import Literal

from app.api.schemas.base import Outgoing


class Alive(Outgoing):
    """The process answers."""

    status: Literal["alive"] = "alive"


class Ready(Outgoing):
    """The index is loaded, and searches are answered."""

    status: Literal["ready"] = "ready"
    library_version: int
    clips: int
