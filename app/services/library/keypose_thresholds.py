"""The thresholds that find keyposes: those of the library, and those of a clip's stored keyposes.

The library's thresholds are learned from annotations, or else the default ones. A clip keeps those
of its analysis until it is analyzed again, so that everything that shows its keyposes agrees.
"""

from __future__ import annotations

import numpy as np

from app.analysis.energy.energy import EnergyMethod
from app.errors import ModelNotFitted, NotFound
from app.models.keyposes.thresholds import USUAL, Thresholds
from app.numerics.arrays import FloatArray
from app.services.library.library import Library
from app.store.clips import arrays

KEYPOSE_THRESHOLDS = "keypose_thresholds"


def learned_thresholds(
    lib: Library, method: str = EnergyMethod.RMS
) -> tuple[Thresholds | None, int | None]:
    """The learned thresholds of an energy method, and the version of their model; or None."""
    try:
        fitted = lib.models.keyposes(lib.store)
    except ModelNotFitted:
        return None, None
    found = fitted.model.by_method.get(method)
    return found, None if found is None else fitted.version


def library_thresholds(lib: Library) -> Thresholds:
    """The thresholds of new analyses: the learned ones, or else the default ones."""
    return learned_thresholds(lib)[0] or USUAL


def stored_thresholds(lib: Library, clip_id: str) -> Thresholds:
    """The thresholds of a ready clip's stored keyposes.

    If its analysis is older than their storage, they are those of the library.
    """
    try:
        with lib.store.read() as tx:
            t1, t2 = arrays.get_one(tx, clip_id, KEYPOSE_THRESHOLDS)
    except NotFound:
        return library_thresholds(lib)
    return Thresholds(float(t1), float(t2))


def thresholds_array(thresholds: Thresholds) -> FloatArray:
    """(2,) float64 T1 and T2, as an analysis stores them."""
    return np.array([thresholds.t1, thresholds.t2])
