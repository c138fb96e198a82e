"""A process that the supervisor keeps running, and what it knows of it."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

FIRST_DELAY_S, MAX_DELAY_S = 0.5, 30.0
"""Delay before a dead process is started again; it doubles with each early death."""


@dataclass(slots=True)
class SupervisedProcess:
    """A process that the supervisor keeps running.

    arguments: of Python; started, next_start: seconds of the monotonic clock; delay: seconds
    before the next start after a death; has_been_steady: whether it ever ran for STEADY_S; files:
    descriptors that it inherits; variables: of its environment, besides those of all processes.
    """

    name: str
    arguments: Sequence[str]
    process: subprocess.Popen[bytes] | None = None
    started: float = 0.0
    next_start: float = 0.0
    delay: float = FIRST_DELAY_S
    has_been_steady: bool = False
    files: tuple[int, ...] = ()
    variables: Mapping[str, str] = field(default_factory=dict)
