"""What is fitted on the library."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing
from app.services.library.fitted_models import FALSE_ACCEPT_RATE
from app.services.training.active_errors import Errors
from app.store.models import ModelRecord


class ErrorsInForce(Outgoing):
    """How often a recognizer errs on what is new, at the active threshold: shares of clips that
    were held out at the fit. The threshold was chosen on these clips: for others the errors may be
    a little higher."""

    threshold: float = Field(description="Novelty above which something is called new.")
    false_acceptance: float = Field(ge=0, le=1, description="Of what is new, called known.")
    false_rejection: float = Field(
        ge=0,
        le=1,
        description="Of what is known, called new; where takes were hardly repeated, of further"
        " takes as the recognizer imagines them.",
    )


class Model(Outgoing):
    """A fitted model that is in use."""

    id: str
    kind: str
    version: int
    library_version: int = Field(description="The library's version at the fit.")
    library_size: int = Field(description="Ready clips at the fit, without synthesized ones.")
    figures: dict[str, Any] = Field(
        description="Held-out figures, by name; of a recognizer those of the usual threshold."
        " Those of `multilinear` stand beside the recognizer's."
    )
    false_accept_rate: float | None = Field(
        description="How often this recognizer may call something new known, if that was set."
    )
    errors_in_force: dict[str, ErrorsInForce] | None = Field(
        description="Of a recognizer that calls something unknown: its errors by `person` and"
        " `task` at the threshold in force, which is that of `false_accept_rate` where it is set;"
        " a factor is missing where too few labels could be held out. null of other models."
    )
    created_at: datetime

    @classmethod
    def of(cls, record: ModelRecord, errors: Mapping[str, Errors] | None) -> Model:
        """The model as the API shows it; errors: at the active threshold, by factor."""
        shown = (
            None
            if errors is None
            else {factor: ErrorsInForce.model_validate(found) for factor, found in errors.items()}
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
    """What can be set of a model."""

    false_accept_rate: float | None = Field(
        gt=0,
        lt=1,
        description="Of the models recognizer and perera: how often they may call something new "
        "known; see `curve` in their figures. null: where both errors weigh alike. What comes of "
        "it stands in `errors_in_force`; `figures` stay those of the usual threshold. With enough "
        "clips, a known task counts there only as done by a person who did it before (a "
        "stranger's is called unknown more often).",
        examples=[0.05],
    )


class UnfittedModel(Outgoing):
    """A kind of model that the last fit could not fit; an older one may still be in use."""

    kind: str
    outcome: str = Field(description="skipped, or failed by a defect.")
    reason: str = Field(description="As: too few clips carry a label.")


class ModelList(Outgoing):
    """The current model of each kind; `next` is always null."""

    items: list[Model]
    unfitted: list[UnfittedModel] = Field(description="What the last fit left out, and why.")
    next: str | None = None
