"""Answers: health. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class Alive(Record):
    """The process answers."""

    status: Literal["alive"]


@dataclass(frozen=True, slots=True)
class Ready(Record):
    """The index is loaded, and searches are answered."""

    status: Literal["ready"]
    library_version: int
    clips: int
