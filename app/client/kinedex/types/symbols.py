"""Answers: symbols. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Record


@dataclass(frozen=True, slots=True)
class Channel(Record):
    """One of the 26 channels over time.

    mean: One value per frame: cosine, body lengths, body lengths / s or radians / s.
    spread: Standard deviation at each frame, in the same unit.
    """

    name: str
    mean: list[float]
    spread: list[float]


@dataclass(frozen=True, slots=True, eq=False)
class SymbolMotion(Record):
    """The motion that the symbol of a clip generates (Takano, fig. 6).

    parents: Index of each joint's parent, -1 for a root.
    positions: (frames, joints, 3), meters, Y up.
    states: Number of states of the hidden Markov model.
    """

    frame_rate: float
    joint_names: list[str]
    parents: list[int]
    positions: Array
    states: int
    channels: list[Channel]
