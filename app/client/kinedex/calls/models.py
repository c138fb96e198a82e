"""Calls: models. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from kinedex.call import Call, path_of, record
from kinedex.sent import corrections, given

if TYPE_CHECKING:
    from kinedex.types.jobs import JobStarted
    from kinedex.types.models import ConfusedClips, Confusion, Model, ModelList, Signatures


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


def get_confusion(*, factor: Literal["person", "task"] | None = None) -> Call[Confusion]:
    """What the recognizer takes clips for that it has not seen, as a confusion matrix.

    factor: Persons or tasks. Default: task.
    """
    from kinedex.types.models import Confusion

    return Call(
        "get_confusion",
        "GET",
        "/v1/models/confusion",
        record(Confusion),
        query=given(factor=factor),
    )


def list_confused_clips(
    label: str,
    guess: str,
    *,
    factor: Literal["person", "task"] | None = None,
    limit: int | None = None,
) -> Call[ConfusedClips]:
    """The clips with a label that were taken for `guess`: a cell of the confusion matrix.

    factor: Default: task.
    limit: Maximum number of items in one answer. Default: 100.
    """
    from kinedex.types.models import ConfusedClips

    return Call(
        "list_confused_clips",
        "GET",
        "/v1/models/confusion/clips",
        record(ConfusedClips),
        query=given(label=label, guess=guess, factor=factor, limit=limit),
    )


def list_signatures() -> Call[Signatures]:
    """The signature of each person in the multilinear model, as a point in two dimensions."""
    from kinedex.types.models import Signatures

    return Call("list_signatures", "GET", "/v1/models/signatures", record(Signatures))


def request_fit() -> Call[JobStarted]:
    """Fit all models again in the background. Until the fit ends, searches use the old models."""
    from kinedex.types.jobs import JobStarted

    return Call("request_fit", "POST", "/v1/models/fit", record(JobStarted))
