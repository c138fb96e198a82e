"""Calls: models. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from kinedex.call import OCTETS, Call, path_of, record
from kinedex.positions import Positions, positions
from kinedex.sent import corrections, given

if TYPE_CHECKING:
    from kinedex.types.jobs import JobStarted
    from kinedex.types.models import ConfusedClips, Confusion, Model, ModelList
    from kinedex.types.signatures import Signatures
    from kinedex.types.views import Motion


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


def get_signatures(
    model_id: str,
    *,
    eigenmotions: int | None = None,
    person: Sequence[str] | None = None,
    task: Sequence[str] | None = None,
    limit: int | None = None,
    cursor: str | None = None,
) -> Call[Signatures]:
    """Persons, tasks and eigenmotions of a multilinear model as vectors, and weights of clips.

    Models of the kinds `signatures` (joint angles, as in Vasilescu 2002) and `multilinear`
    (positions) have them.

    eigenmotions: Number of eigenmotions, and of weights of each clip. Default: 8.
    person: Only clips of these persons. Default: [].
    task: Only clips with these tasks. Default: [].
    limit: Maximum number of items in one answer. Default: 100.
    cursor: `next` of the previous answer. The answer starts there.
    """
    from kinedex.types.signatures import Signatures

    return Call(
        "get_signatures",
        "GET",
        path_of("/v1/models/{model_id}/signatures", model_id=model_id),
        record(Signatures),
        query=given(
            eigenmotions=eigenmotions, person=person, task=task, limit=limit, cursor=cursor
        ),
    )


def get_eigenmotion(
    model_id: str, number: int, *, deviations: float | None = None, seconds: float | None = None
) -> Call[Motion]:
    """The mean motion, moved along an eigenmotion, as the motion of a clip: to play it.

    It has the 13 joints of figure 2 in Sun 2011. The body faces Z and stays in place, and its
    lower foot is on the floor.

    deviations: How far from the mean motion, in standard deviations of the weight over all
        persons and tasks. 0 is the mean motion. Default: 2.0.
    seconds: Duration, seconds. It can be chosen, since an eigenmotion has no duration. Default:
        2.0.
    """
    from kinedex.types.views import Motion

    return Call(
        "get_eigenmotion",
        "GET",
        path_of(
            "/v1/models/{model_id}/eigenmotions/{number}/motion", model_id=model_id, number=number
        ),
        record(Motion),
        query=given(deviations=deviations, seconds=seconds),
    )


def get_eigenmotion_array(
    model_id: str, number: int, *, deviations: float | None = None, seconds: float | None = None
) -> Call[Positions]:
    """The mean motion, moved along an eigenmotion, as the motion of a clip: to play it. The answer
    is an array.

    It has the 13 joints of figure 2 in Sun 2011. The body faces Z and stays in place, and its
    lower foot is on the floor.

    deviations: How far from the mean motion, in standard deviations of the weight over all
        persons and tasks. 0 is the mean motion. Default: 2.0.
    seconds: Duration, seconds. It can be chosen, since an eigenmotion has no duration. Default:
        2.0.
    """
    return Call(
        "get_eigenmotion",
        "GET",
        path_of(
            "/v1/models/{model_id}/eigenmotions/{number}/motion", model_id=model_id, number=number
        ),
        positions,
        query=given(deviations=deviations, seconds=seconds),
        accept=OCTETS,
    )


def request_fit() -> Call[JobStarted]:
    """Fit all models again in the background. Until the fit ends, searches use the old models."""
    from kinedex.types.jobs import JobStarted

    return Call("request_fit", "POST", "/v1/models/fit", record(JobStarted))
