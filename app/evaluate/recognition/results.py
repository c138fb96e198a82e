"""What an evaluation of recognition found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.evaluate.recognition.clips import JudgedClips
from app.evaluate.recognition.perera import PereraEvaluation
from app.evaluate.recognition.rounds import LeftOut
from app.evaluate.recognition.shares import Recognized, Unknown
from app.numerics.arrays import FloatArray

Made = Mapping[str, Sequence[Mapping[str, Any]]]
"""Rows by kind, "new_task" and "new_person"."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One method where something is held out in one way.

    recognized: of clips whose label had been seen, the best candidate counts, be it called
    known or not; of_new: the same of those clips alone whose label was left out (of the
    other factor, then); unknown: by factor, where new and known clips were asked about;
    confusion: by factor, C labels and (C, C) shares; by_name: `recognized` by what was left
    out.
    """

    method: str
    recognized: Recognized
    of_new: Recognized
    unknown: Mapping[str, Unknown]
    confusion: Mapping[str, tuple[tuple[str, ...], FloatArray]]
    by_name: Mapping[str, Recognized]


@dataclass(frozen=True, slots=True)
class HeldOut:
    """All methods where something is held out in one way.

    rounds: how many models each method was fitted for; chance: of person, task and both, what
    guessing comes to.
    """

    rounds: int
    methods: tuple[Judged, ...]
    chance: tuple[float | None, float | None, float | None]


@dataclass(frozen=True, slots=True)
class WhenTold:
    """A method with each recording left out (Vasilescu): neither label told, or the other."""

    method: str
    neither: Recognized
    told: Recognized


@dataclass(frozen=True, slots=True)
class Seconds:
    """Medians over rounds: of a fit, and of a probe after its features."""

    fit: float
    probe: float


@dataclass(frozen=True, slots=True)
class RecognitionEvaluation:
    """What `kinedex evaluate recognition` tells.

    clips: what is judged; held_out: by what was left out; takes: by takes a cell; told:
    Vasilescu's; seconds: by method; perera: his tables; made: Vasilescu's check of what is
    synthesized (section 7), see `held_out_synthesis`; not_judged: why what is missing is
    missing, by its name.
    """

    clips: JudgedClips
    held_out: Mapping[LeftOut, HeldOut]
    takes: Mapping[int, HeldOut]
    told: tuple[WhenTold, ...]
    seconds: Mapping[str, Seconds]
    not_judged: dict[str, str]
    perera: PereraEvaluation | None = None
    made: Made | None = None
