"""Signatures: the parameters of each person in the multilinear model, as points to look at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.principal_axes import principal_axes
from app.services.library.library import Library

DIMENSIONS = 2


def signature_points(lib: Library) -> tuple[Sequence[str], FloatArray, float]:
    """The persons, their signatures (persons, 2) along their principal axes, and the share of
    their variance that these axes keep.

    Each parameter counts by how much it changes motions, its singular value: without that, all
    signatures are equally far apart. Raises ModelNotFitted.
    """
    model = lib.models.multilinear(lib.store).model
    core, people = model.svd.core, model.svd.factors[0]
    signatures = people * np.linalg.norm(core.reshape(len(core), -1), axis=1)
    axes = principal_axes(signatures, DIMENSIONS)
    points = axes.project(signatures)
    whole = float(np.square(signatures - axes.center).sum())
    kept = float(np.square(points).sum()) / whole if whole > 0 else 1.0
    return model.persons, np.pad(points, ((0, 0), (0, DIMENSIONS - points.shape[1]))), kept
