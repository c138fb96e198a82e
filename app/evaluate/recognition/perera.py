"""Perera's experiments on a library's own dances: Tables 3, 4 and 5 (2009, section 5.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.analysis.segments.danced_cycles import danced_cycles
from app.analysis.segments.segments import SEGMENT_CYCLES, SEGMENT_SPANS
from app.errors import NotEnoughLabels
from app.models.held_out.danced_tasks import DancedTasks, arrange
from app.models.held_out.perera_experiment import Row, perera_tables
from app.models.recognition.task_model import Reading
from app.search.example.distances import FEATURES
from app.services.library.library import Library
from app.services.training.training_set import ready_only
from app.store.clips import arrays
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter

_NAMES = (FEATURES, SEGMENT_SPANS, SEGMENT_CYCLES)


@dataclass(frozen=True, slots=True)
class PereraEvaluation:
    """Figures of Perera's experiments.

    segments: motions from keypose to keypose (each segment of a repeated sequence counts), of
    `clips` clips, `persons` persons and `tasks` tasks; tables: rows for each reading of eq. 14.
    """

    segments: int
    clips: int
    persons: int
    tasks: int
    tables: Mapping[Reading, tuple[Row, ...]]


def judge_perera(lib: Library, filter: ClipFilter | None = None) -> PereraEvaluation:
    """Run the experiments on the ready clips that pass the filter and carry both labels.

    Raises NotEnoughLabels if too few persons do the same tasks twice, or if the setting
    `recognize_persons` is off.
    """
    if not lib.settings.recognize_persons:
        raise NotEnoughLabels("Persons are not to be recognized here (recognize_persons).")
    danced, used = _read(lib, filter)
    return PereraEvaluation(
        segments=len(danced),
        clips=used,
        persons=len(set(danced.persons)),
        tasks=len(set(danced.tasks)),
        tables={reading: perera_tables(danced, reading) for reading in Reading},
    )


def _read(lib: Library, filter: ClipFilter | None) -> tuple[DancedTasks, int]:
    """The segments, and the number of clips that they come from."""
    with lib.store.read() as tx:
        ids = sorted(clip_listing.list_ids(tx, ready_only(filter)))
        records = {
            id_: clip for id_, clip in clips.get_many(tx, ids).items() if clip.person and clip.task
        }
        found = {name: arrays.get_many(tx, sorted(records), name) for name in _NAMES}
    use = [id_ for id_ in sorted(records) if id_ in found[FEATURES]]
    danced = arrange(
        [danced_cycles(_of_clip(found, id_)) for id_ in use],
        [records[id_].person for id_ in use],
        [records[id_].task for id_ in use],
    )
    return danced, len(use)


def _of_clip(found: Mapping[str, Mapping[str, Any]], clip_id: str) -> dict[str, Any]:
    """The arrays of one clip; without stored segments it counts as one that repeats nothing."""
    none = {SEGMENT_SPANS: np.zeros((0, 2)), SEGMENT_CYCLES: np.zeros((0, 3))}
    return {name: found[name].get(clip_id, none.get(name)) for name in _NAMES}
