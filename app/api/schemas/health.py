"""Health of the service: alive, ready."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from app.api.schemas.base import Outgoing
from app.api.schemas.problem import ProblemPlace


class Alive(Outgoing):
    """The process answers."""

    status: Literal["alive"] = "alive"


class Ready(Outgoing):
    """The index is loaded, and searches are answered."""

    status: Literal["ready"] = "ready"
    library_version: int
    clips: int
    is_warm: bool = Field(
        description="Whether the first search of each kind is as fast as later ones. Until then, "
        "it also loads an index or a model."
    )
    warnings: list[ProblemPlace] = Field(
        description="What is damaged although every call can be answered, such as stored files: "
        "`kinedex doctor --mend` mends it.",
    )
