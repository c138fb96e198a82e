"""What is fitted on the library."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from pydantic import Field

from app.api.schemas.base import Incoming, Outgoing
from app.services import models as services
from app.services.model_shelf import FALSE_ACCEPT_RATE
from app.store.models import ModelRecord


class Model(Outgoing):
    """A fitted model that is in use."""

    id: str
    kind: str
    version: int
    library_version: int = Field(description="The library's version at the fit.")
    library_size: int = Field(description="Ready clips at the fit, without synthesized ones.")
    figures: dict[str, Any] = Field(description="Held-out figures, by name.")
    false_accept_rate: float | None = Field(
        description="How often this recogniser may call something new known, if that was set."
    )
    created_at: datetime

    @classmethod
    def of(cls, record: ModelRecord) -> Model:
        """A model as it goes over the wire."""
        return cls(
            id=record.id,
            kind=record.kind,
            version=record.version,
            library_version=record.library_version,
            library_size=record.library_size,
            figures=dict(record.meta.get("figures", {})),
            false_accept_rate=record.settings.get(FALSE_ACCEPT_RATE),
            created_at=record.created_at,
        )


class ModelPatch(Incoming):
    """What can be set of a model."""

    false_accept_rate: float | None = Field(
        gt=0,
        lt=1,
        description="Of the models recogniser and perera: how often they may call something new "
        "known; see `curve` in their figures. null: where both errors weigh alike. The figures "
        "stay those of the usual threshold; with enough clips, a known task counts there only as "
        "done by a person who did it before (a stranger's is called unknown more often).",
        examples=[0.05],
    )


class UnfittedModel(Outgoing):
    """A kind of model that the last fit could not fit; an older one may still be in use."""

    kind: str
    outcome: str = Field(description="skipped, or failed by a defect.")
    reason: str = Field(description="As: too few clips carry a label.")

    @classmethod
    def of(cls, unfitted: services.Unfitted) -> UnfittedModel:
        """An unfitted kind as it goes over the wire."""
        return cls(kind=unfitted.kind, outcome=unfitted.outcome, reason=unfitted.reason)


class ModelList(Outgoing):
    """The current model of each kind; `next` is always null."""

    items: list[Model]
    unfitted: list[UnfittedModel] = Field(description="What the last fit left out, and why.")
    next: str | None = None
