"""Calls: models. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import Call, path_of, record
from kinedex.sent import corrections

if TYPE_CHECKING:
    from kinedex.types.jobs import JobStarted
    from kinedex.types.models import Model, ModelList


def list_models() -> Call[ModelList]:
    """The current model of each kind, with the library's size at the fit and held-out figures."""
    from kinedex.types.models import ModelList

    return Call("list_models", "GET", "/v1/models", record(ModelList))


def update_model(model_id: str, false_accept_rate: float | None) -> Call[Model]:
    """Set the false-accept rate of a recognizer. It applies at once, and also after later fits.

    false_accept_rate: For the models recognizer and perera: the allowed share of new persons or
        tasks that are called known (see `curve` in their figures). null: the threshold at which
        both errors have equal weight. `errors_in_force` shows the resulting errors; `figures`
        keep those of the default threshold. With enough clips, `errors_in_force` counts a known
        task only if a person does it who did it before. For a new person, a known task is called
        unknown more often.
    """
    from kinedex.types.models import Model

    return Call(
        "update_model",
        "PATCH",
        path_of("/v1/models/{model_id}", model_id=model_id),
        record(Model),
        json=corrections(false_accept_rate=false_accept_rate),
    )


def request_fit() -> Call[JobStarted]:
    """Fit all models again in the background. Until then, searches use the old models."""
    from kinedex.types.jobs import JobStarted

    return Call("request_fit", "POST", "/v1/models/fit", record(JobStarted))
