"""Answers: models. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

from kinedex.records import Page, Record
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class ConfusedClips(Page[Clip]):
    """The clips of a cell of the confusion matrix; `next` is always null."""

    items: list[Clip]
    next: str | None


@dataclass(frozen=True, slots=True)
class ConfusionCell(Record):
    """Clips with one label that were taken for one label."""

    label: str
    guess: str
    count: int


@dataclass(frozen=True, slots=True)
class Confusion(Page[ConfusionCell]):
    """The confusion matrix of the default recognizer; `next` is always null.

    Each clip was recognized by a model that was fitted without its recording. Labels are those at
    the fit.

    names: All labels, sorted.
    items: The cells that hold clips.
    """

    factor: Literal["person", "task"]
    names: list[str]
    items: list[ConfusionCell]
    next: str | None


@dataclass(frozen=True, slots=True)
class ErrorsInForce(Record):
    """Error rates of a recognizer for new persons or tasks at the active threshold.

    They are shares of the clips that were held out at the fit. The threshold was chosen on the same
    clips, so the errors on other clips may be a little higher.

    threshold: A person or task with a higher novelty is called new.
    false_acceptance: Share of new ones that are called known.
    false_rejection: Share of known ones that are called new. If there are too few repeated
    takes, it is estimated on further takes that the recognizer simulates.
    """

    threshold: float
    false_acceptance: float
    false_rejection: float


@dataclass(frozen=True, slots=True)
class Model(Record):
    """The fitted model of a kind that is in use.

    library_version: The library's version at the fit.
    library_size: Number of ready clips at the fit, without synthesized clips.
    figures: Held-out figures, by name. For a recognizer, they are measured at the default
    threshold. The recognizer's figures also include those of `multilinear`.
    false_accept_rate: The allowed share of new persons or tasks that are called known, if set.
    errors_in_force: Errors by `person` and `task`, for a recognizer that can answer unknown.
    They are measured at the active threshold, which `false_accept_rate` sets. `person` or
    `task` is missing if too few labels could be held out. null for other models.
    """

    id: str
    kind: str
    version: int
    library_version: int
    library_size: int
    figures: dict[str, Any]
    false_accept_rate: float | None
    errors_in_force: dict[str, ErrorsInForce] | None
    created_at: datetime


@dataclass(frozen=True, slots=True)
class UnfittedModel(Record):
    """A kind of model that the last fit could not fit. An older model may still be in use.

    outcome: skipped, or failed because of a defect.
    reason: For example: too few clips carry a label.
    """

    kind: str
    outcome: str
    reason: str


@dataclass(frozen=True, slots=True)
class ModelList(Page[Model]):
    """The current model of each kind; `next` is always null.

    unfitted: Kinds of models that the last fit could not fit.
    """

    items: list[Model]
    unfitted: list[UnfittedModel]
    next: str | None
