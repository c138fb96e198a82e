"""Answers: health. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinedex.records import Record
from kinedex.types.problem import ProblemPlace


@dataclass(frozen=True, slots=True)
class Alive(Record):
    """The process answers."""

    status: Literal["alive"]


@dataclass(frozen=True, slots=True)
class Ready(Record):
    """The index is loaded, and searches are answered.

    is_warm: Whether the first search of each kind is as fast as later ones. Until then, it also
    loads an index or a model.
    warnings: What is damaged although every call can be answered, such as stored files:
    `kinedex doctor --mend` mends it.
    """

    status: Literal["ready"]
    library_version: int
    clips: int
    is_warm: bool
    warnings: list[ProblemPlace]
