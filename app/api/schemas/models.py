"""Models that are fitted on the library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any, Literal

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing
from app.api.schemas.clips import Clip
from app.services.library.fitted_models import FALSE_ACCEPT_RATE
from app.services.recognition.confusion import Cell
from app.services.training.active_errors import Errors
from app.store.models import ModelRecord


class ErrorsInForce(Outgoing):
    """Error rates of a recognizer for new persons or tasks at the active threshold.

    They are shares of the clips that were held out at the fit. The threshold was chosen on the same
    clips, so the errors on other clips may be a little higher.
    """

    threshold: float = Field(description="A person or task with a higher novelty is called new.")
    false_acceptance: float = Field(
        ge=0, le=1, description="Share of new ones that are called known."
    )
    false_rejection: float = Field(
        ge=0,
        le=1,
        description="Share of known ones that are called new. If there are too few repeated takes,"
        " it is estimated on further takes that the recognizer simulates.",
    )


class Model(Outgoing):
    """The fitted model of a kind that is in use."""

    id: str
    kind: str
    version: int
    library_version: int = Field(description="The library's version at the fit.")
    library_size: int = Field(
        description="Number of ready clips at the fit, without synthesized clips."
    )
    figures: dict[str, Any] = Field(
        description="Held-out figures, by name. For a recognizer, they are measured at the default"
        " threshold. The recognizer's figures also include those of `multilinear`."
    )
    false_accept_rate: float | None = Field(
        description="The allowed share of new persons or tasks that are called known, if set."
    )
    errors_in_force: dict[str, ErrorsInForce] | None = Field(
        description="Errors by `person` and `task`, for a recognizer that can answer unknown. They"
        " are measured at the active threshold, which `false_accept_rate` sets. `person` or `task`"
        " is missing if too few labels could be held out. null for other models."
    )
    created_at: datetime

    @classmethod
    def of(cls, record: ModelRecord, errors: Mapping[str, Errors] | None) -> Model:
        """The model as the API shows it. errors: those at the active threshold, by factor."""
        shown = (
            None
            if errors is None
            else {factor: ErrorsInForce.model_validate(rates) for factor, rates in errors.items()}
        )
        return cls(
            id=record.id,
            kind=record.kind,
            version=record.version,
            library_version=record.library_version,
            library_size=record.library_size,
            figures=dict(record.meta.get("figures", {})),
            false_accept_rate=record.settings.get(FALSE_ACCEPT_RATE),
            errors_in_force=shown,
            created_at=record.created_at,
        )


class ModelPatch(Incoming):
    """The settings of a model."""

    false_accept_rate: float | None = Field(
        gt=0,
        lt=1,
        description="For the models recognizer and perera: the allowed share of new persons or "
        "tasks that are called known (see `curve` in their figures). null: the threshold at which "
        "both errors have equal weight. `errors_in_force` shows the resulting errors; `figures` "
        "keep those of the default threshold. With enough clips, `errors_in_force` counts a known "
        "task only if a person does it who did it before. For a new person, a known task is called "
        "unknown more often.",
        examples=[0.05],
    )


class UnfittedModel(Outgoing):
    """A kind of model that the last fit could not fit. An older model may still be in use."""

    kind: str
    outcome: str = Field(description="skipped, or failed because of a defect.")
    reason: str = Field(description="For example: too few clips carry a label.")


class ModelList(Outgoing):
    """The current model of each kind; `next` is always null."""

    items: list[Model]
    unfitted: list[UnfittedModel] = Field(
        description="Kinds of models that the last fit could not fit."
    )
    next: str | None = None


Factor = Literal["person", "task"]


class ConfusionQuery(Incoming):
    """What is recognized."""

    factor: Factor = Field("task", description="Persons or tasks.")


class ConfusionCell(Outgoing):
    """Clips with one label that were taken for one label."""

    label: str
    guess: str
    count: int = Field(ge=1)


class Confusion(Outgoing):
    """The confusion matrix of the default recognizer; `next` is always null.

    Each clip was recognized by a model that was fitted without its recording. Labels are those at
    the fit.
    """

    factor: Factor
    names: list[str] = Field(description="All labels, sorted.")
    items: list[ConfusionCell] = Field(description="The cells that hold clips.")
    next: str | None = None

    @classmethod
    def of(cls, factor: Factor, names: Sequence[str], cells: Sequence[Cell]) -> Confusion:
        """The matrix as the API shows it."""
        items = [ConfusionCell.model_validate(cell) for cell in cells]
        return cls(factor=factor, names=list(names), items=items)


class ConfusedClips(Outgoing):
    """The clips of a cell of the confusion matrix; `next` is always null."""

    items: list[Clip]
    next: str | None = None
