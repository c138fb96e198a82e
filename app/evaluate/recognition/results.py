"""Value types with the results of an evaluation of recognition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.evaluate.recognition.clips import JudgedClips
from app.evaluate.recognition.perera import PereraEvaluation
from app.evaluate.recognition.rounds import LeftOut
from app.evaluate.recognition.shares import Recognized, Unknown
from app.numerics.arrays import FloatArray

SynthesisRows = Mapping[str, Sequence[Mapping[str, Any]]]
"""The figures of synthesized motions by kind, "new_task" and "new_person"."""


@dataclass(frozen=True, slots=True)
class Judged:
    """The figures of one method under one way of holding out.

    recognized: shares of clips with labels that the method has seen; the best candidate counts,
    even if the method calls it new; of_new: the same for the clips alone whose label was left
    out (these shares are of the other factor); unknown: by factor, if both new and known clips
    were probed; confusion: by factor, C labels and (C, C) shares; by_name: `recognized` by what
    was left out; by_group: `recognized` by the reported group of the probed clips; task_in_tree: as
    the share of tasks, but an error within a branch of the tree of labels weighs less.
    """

    method: str
    recognized: Recognized
    of_new: Recognized
    unknown: Mapping[str, Unknown]
    confusion: Mapping[str, tuple[tuple[str, ...], FloatArray]]
    by_name: Mapping[str, Recognized]
    by_group: Mapping[str, Recognized]
    task_in_tree: float | None


@dataclass(frozen=True, slots=True)
class HeldOut:
    """The figures of all methods under one way of holding out.

    rounds: the number of models that each method fitted; chance: the shares of person, task and
    both that guessing reaches.
    """

    rounds: int
    methods: tuple[Judged, ...]
    chance: tuple[float | None, float | None, float | None]


@dataclass(frozen=True, slots=True)
class LabelGiven:
    """One method with each recording left out in turn (Vasilescu 2002, section 7).

    neither: shares when no label is given; given: shares when the other label is given.
    """

    method: str
    neither: Recognized
    given: Recognized


@dataclass(frozen=True, slots=True)
class Seconds:
    """Medians over rounds: of a fit, and of a probe (without the computation of its features)."""

    fit: float
    probe: float


@dataclass(frozen=True, slots=True)
class RecognitionEvaluation:
    """The results of `kinedex evaluate recognition`.

    clips: the judged clips; held_out: by what was left out; takes: by the number of takes of
    each cell in training; label_given: Vasilescu's experiment; seconds: by method; perera:
    Perera's tables; made: Vasilescu's check of synthesized motions (section 7), see
    `held_out_synthesis`; not_judged: for each missing part, the reason.
    """

    clips: JudgedClips
    held_out: Mapping[LeftOut, HeldOut]
    takes: Mapping[int, HeldOut]
    label_given: tuple[LabelGiven, ...]
    seconds: Mapping[str, Seconds]
    not_judged: dict[str, str]
    perera: PereraEvaluation | None = None
    made: SynthesisRows | None = None
