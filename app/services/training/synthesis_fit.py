"""Fits the synthesis model on a library."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH
from app.models.held_out.synthesis import expected_hits, held_out_rows, judge_trials
from app.models.synthesis.model import Synthesis, fit_synthesis
from app.search.index import usable_arrays
from app.services.training.training_set import TrainingSet
from app.store.store import Store

SHAPE = "motion_shape"
EXPECTED_HITS = "expected_hits"
"""Name of the curves of `ExpectedHits`, by kind, among the figures."""


def fit_synthesis_on(store: Store, training: TrainingSet) -> tuple[Synthesis, dict[str, Any]]:
    """The model and its held-out figures, from the clips with a motion shape and both labels.

    Raises NotEnoughLabels if the labels are too few.
    """
    labels = zip(training.clips, training.persons, training.tasks, strict=True)
    labeled = [(clip.id, person, task) for clip, person, task in labels if person and task]
    with store.read() as tx:
        found = usable_arrays.get_many(tx, [clip_id for clip_id, _, _ in labeled], SHAPE)
    labeled = [
        row for row in labeled if row[0] in found
    ]  # clips of an older analysis have no shape
    shapes = np.array([found[clip_id] for clip_id, _, _ in labeled]).reshape(-1, SHAPE_LENGTH)
    ids, persons, tasks = ([row[column] for row in labeled] for column in range(3))
    model = fit_synthesis(shapes, persons, tasks, ids)
    judged = judge_trials(model)
    held_out = held_out_rows(model, judged)
    return model, {"held_out": held_out, EXPECTED_HITS: expected_hits(judged)}
