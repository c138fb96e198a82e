"""The error rates of a recognizer on new persons and tasks, at its active threshold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from app.errors import ModelNotFitted
from app.models.recognition.calibration import Calibration
from app.models.recognition.perera import TensorRecognizer
from app.models.recognition.recognizer import Recognizer
from app.services.library.fitted_models import KINDS_WITH_UNKNOWN, Fitted, ModelKind
from app.services.library.library import Library
from app.store.models import ModelRecord


@dataclass(frozen=True, slots=True)
class Errors:
    """Error rates on clips that were held out of the fit.

    threshold: the novelty above which a clip is called new; false_acceptance: share of the new
    clips that are called known; false_rejection: share of the known clips that are called new.
    """

    threshold: float
    false_acceptance: float
    false_rejection: float


def active_errors(lib: Library, record: ModelRecord) -> Mapping[str, Errors] | None:
    """The errors by "person" and "task" at the configured false-accept rate, or at the fitted
    threshold. A factor without held-out clips is missing.

    None for models that call nothing unknown, and for a model that was just replaced.
    """
    if record.kind not in KINDS_WITH_UNKNOWN:
        return None
    try:
        fitted = _active(lib, record.kind)
    except ModelNotFitted:
        return None
    if fitted.id != record.id:
        return None
    model = fitted.model
    calibrations = {"person": model.person_calibration, "task": model.task_calibration}
    return {factor: _errors(one) for factor, one in calibrations.items() if one.is_judged}


def _active(lib: Library, kind: str) -> Fitted[Recognizer] | Fitted[TensorRecognizer]:
    if kind == ModelKind.PERERA:
        return lib.models.perera(lib.store)
    return lib.models.recognizer(lib.store)


def _errors(calibration: Calibration) -> Errors:
    return Errors(calibration.threshold, *calibration.error_rates())
