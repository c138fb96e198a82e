"""Signatures, actions and eigenmotions of a multilinear model (Vasilescu 2002), to look at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.errors import ModelNotFitted, NoSignatures, NotFound
from app.kinedex_error import Place
from app.models.recognition.multilinear import Multilinear
from app.models.signatures.clips import ClipParameters, clip_parameters
from app.models.signatures.coordinates import ANGLES_OF_JOINTS, POSITIONS, Coordinates
from app.models.signatures.eigenmotions import Eigenmotions, eigenmotions
from app.models.signatures.parameters import Parameters, person_parameters, task_parameters
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.services import fields
from app.services.clips.catalogue import list_clips
from app.services.library.fitted_models import KINDS_WITH_SIGNATURES, ModelKind
from app.services.library.library import Library
from app.services.recognition.recognize import ANGLES, SAMPLE
from app.services.training.training_set import ready_only
from app.services.views.views import MotionView
from app.store import models as stored
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.database.paging import Page
from app.store.models import ModelRecord

MAX_EIGENMOTIONS = 100
MAX_DEVIATIONS = 6.0
SECONDS = (0.5, 60.0)
"""Bounds of the duration of an eigenmotion that is played."""


@dataclass(frozen=True, slots=True)
class ClipWeights:
    """A clip and its parameters; person_point, task_point: (2,) places of its signature and of its
    action in the plots of persons and tasks, None where the parameters are None."""

    clip: ClipRecord
    parameters: ClipParameters
    person_point: FloatArray | None
    task_point: FloatArray | None


@dataclass(frozen=True, slots=True)
class Signatures:
    """A multilinear model to look at, and a page of clips with their weights."""

    record: ModelRecord
    coordinates: Coordinates
    persons: Parameters
    tasks: Parameters
    motions: Eigenmotions
    clips: Page[ClipWeights]


@dataclass(frozen=True, slots=True)
class _Fitted:
    """A multilinear model; array: the name of the array that it reads of a clip."""

    record: ModelRecord
    model: Multilinear
    coordinates: Coordinates
    array: str


def signatures(
    lib: Library,
    model_id: str,
    clip_filter: ClipFilter | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> Signatures:
    """The signatures of a model, and the weights of the clips that pass a filter, sorted by name.

    Only clips that were recorded are listed. Raises NotFound, NoSignatures, ModelNotFitted, and
    PageNotFound for a bad cursor.
    """
    fitted = _fitted(lib, model_id)
    persons, tasks = person_parameters(fitted.model), task_parameters(fitted.model)
    motions = eigenmotions(fitted.model)
    page = list_clips(lib, ready_only(clip_filter), "name", limit, cursor)
    with lib.store.read() as tx:
        arrays = usable_arrays.get_many(tx, [clip.id for clip in page.items], fitted.array)
    shown = [clip for clip in page.items if clip.id in arrays]
    found: list[ClipParameters] = []
    if shown:
        samples = np.stack([arrays[clip.id] for clip in shown]).astype(np.float64)
        who, what = [clip.person for clip in shown], [clip.task for clip in shown]
        found = clip_parameters(fitted.model, motions, samples, who, what)
    weights = tuple(
        ClipWeights(clip, own, _point(persons, own.signature), _point(tasks, own.action))
        for clip, own in zip(shown, found, strict=True)
    )
    listed = Page(weights, page.next, page.total, page.total_is_exact)
    return Signatures(fitted.record, fitted.coordinates, persons, tasks, motions, listed)


def eigenmotion(
    lib: Library, model_id: str, number: int, deviations: float = 0.0, seconds: float = 2.0
) -> MotionView:
    """The mean motion, moved by some standard deviations along an eigenmotion, as 13 joint roles.

    number: from 1; deviations: standard deviations over all persons and tasks; 0 is the mean
    motion. Raises NotFound, NoSignatures, ModelNotFitted, BadField.
    """
    if not abs(deviations) <= MAX_DEVIATIONS:
        limit = f"must be from -{MAX_DEVIATIONS:g} to {MAX_DEVIATIONS:g}"
        raise fields.bad_field("deviations", limit)
    if not SECONDS[0] <= seconds <= SECONDS[1]:
        raise fields.bad_field("seconds", f"must be from {SECONDS[0]:g} to {SECONDS[1]:g}")
    fitted = _fitted(lib, model_id)
    motions = eigenmotions(fitted.model)
    if not 1 <= number <= len(motions):
        message = f"must be from 1 to {len(motions)}"
        raise NotFound(
            f"The model {model_id} has no eigenmotion {number}: it {message}.",
            places=[Place("number", message)],
        )
    played = fitted.coordinates.played(motions.along(number - 1, deviations), seconds)
    names = tuple(role.value for role in SUN_ROLES)
    return MotionView(ANALYSIS_RATE, names, SUN_PARENTS, played.astype(np.float32))


def _fitted(lib: Library, model_id: str) -> _Fitted:
    """The active multilinear model with an id. Raises NotFound, NoSignatures, ModelNotFitted."""
    with lib.store.read() as tx:
        record = stored.get(tx, model_id)
    if record.kind not in KINDS_WITH_SIGNATURES:
        kinds = " and ".join(KINDS_WITH_SIGNATURES)
        raise NoSignatures(
            f"A {record.kind} model has no signatures: the models {kinds} have them."
        )
    if not lib.settings.recognize_persons:
        raise ModelNotFitted(
            "Signatures describe persons, and models of persons are switched off"
            " (KINEDEX_RECOGNIZE_PERSONS)."
        )
    is_of_angles = record.kind == ModelKind.SIGNATURES
    fitted = (lib.models.signatures if is_of_angles else lib.models.multilinear)(lib.store)
    if fitted.id != model_id:
        raise NotFound(
            f"The model {model_id} was replaced by version {fitted.version} of {record.kind}:"
            f" {fitted.id}"
        )
    if is_of_angles:
        return _Fitted(record, fitted.model, ANGLES_OF_JOINTS, ANGLES)
    return _Fitted(record, fitted.model, POSITIONS, SAMPLE)


def _point(parameters: Parameters, vector: FloatArray | None) -> FloatArray | None:
    return None if vector is None else parameters.points(vector[None])[0]
