"""Compares found keyposes with annotated ones: Table 1 and figures 4 and 5 of Perera 2009.

The thresholds for a clip are learned from the other recordings. There are also figures with the
usual thresholds, and of the method by hands and feet with which Perera compares the energies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.analysis.energy.energy import EnergyMethod
from app.analysis.keyposes.end_effectors import end_effector_candidates
from app.errors import NotEnoughLabels
from app.evaluate.grouping import Grouping, grouped
from app.models.keyposes.matching import TOLERANCE, Counts, match, total
from app.models.keyposes.thresholds import (
    USUAL,
    Example,
    ThresholdCurve,
    Thresholds,
    curve_of_t1,
    curve_of_t2,
    threshold_grid,
)
from app.services import fields
from app.services.library.library import Library
from app.services.training.annotated import AnnotatedClip, annotated_ids, read_annotated
from app.services.training.keypose_learning import NO_ANNOTATED_CLIP, examples_of
from app.store.clips.filter import ClipFilter

END_EFFECTORS = "end-effectors"
JUDGED_KEYPOSES = (*(method.value for method in EnergyMethod), END_EFFECTORS)
"""The energy methods, and the method by hands and feet."""

NO_ANNOTATIONS = (
    f"{NO_ANNOTATED_CLIP} Name some with PUT /v1/clips/{{id}}/keyposes, or in the column "
    "`keyposes` of a manifest."
)


@dataclass(frozen=True, slots=True)
class JudgedClip:
    """A row of Table 1: the number of a clip's keyposes, and the results of each method.

    group: for which counts are added up, None without groups.
    """

    clip_id: str
    name: str
    task: str | None
    true: int
    counts: Mapping[str, Counts]
    group: str | None = None


@dataclass(frozen=True, slots=True)
class JudgedKeyposes:
    """The results of one method over all clips.

    counts: with thresholds learned from the other recordings; usual: with the usual ones;
    learned: the thresholds from all clips; t1, t2: the curves of figs 4 and 5, with the other
    threshold fixed at the learned value.
    """

    method: str
    counts: Counts
    usual: Counts
    learned: Thresholds
    t1: ThresholdCurve
    t2: ThresholdCurve


@dataclass(frozen=True, slots=True)
class KeyposeEvaluation:
    """tolerance: largest distance in seconds of a match; recordings: number of recordings."""

    tolerance: float
    recordings: int
    clips: tuple[JudgedClip, ...]
    methods: tuple[JudgedKeyposes, ...]

    def by_group(self, method: str) -> dict[str, Counts]:
        """The held-out counts of a method for each group of clips; empty without groups."""
        of_a_group = [clip for clip in self.clips if clip.group is not None]
        parts = grouped([clip.group or "" for clip in of_a_group], of_a_group)
        return {group: total(clip.counts[method] for clip in part) for group, part in parts.items()}


def is_any_annotated(lib: Library, filter: ClipFilter | None = None) -> bool:
    """Whether the library has an annotated clip that passes the filter."""
    return bool(annotated_ids(lib.store, filter))


def judge_keyposes(
    lib: Library,
    filter: ClipFilter | None = None,
    tolerance: float = TOLERANCE,
    by: str | None = None,
) -> KeyposeEvaluation:
    """Judge all annotated clips that pass the filter.

    by: counts for each group of clips too, see `Grouping`. Raises BadField, NotEnoughLabels.
    """
    grouping = Grouping.of(by)
    if not 0 < tolerance <= 1:
        raise fields.bad_field("tolerance", "must be above 0 and at most 1 s")
    annotated = read_annotated(lib.store, filter)
    if not annotated:
        raise NotEnoughLabels(NO_ANNOTATIONS)
    reported = None if grouping is None else grouping.groups([one.clip for one in annotated])
    groups = [clip.group for clip in annotated]
    examples = {method: _examples(annotated, method) for method in JUDGED_KEYPOSES}
    grids = {method: threshold_grid(some, tolerance) for method, some in examples.items()}
    counts = {
        method: [found for _, found in grid.held_out(groups)] for method, grid in grids.items()
    }
    return KeyposeEvaluation(
        tolerance=tolerance,
        recordings=len(set(groups)),
        clips=tuple(
            JudgedClip(
                clip_id=clip.clip.id,
                name=clip.clip.full_name,
                task=clip.clip.task,
                true=len(clip.true),
                counts={method: counts[method][index] for method in JUDGED_KEYPOSES},
                group=None if reported is None else reported[index],
            )
            for index, clip in enumerate(annotated)
        ),
        methods=tuple(
            _judged(method, some, total(counts[method]), grids[method].learned(), tolerance)
            for method, some in examples.items()
        ),
    )


def _examples(annotated: Sequence[AnnotatedClip], method: str) -> list[Example]:
    if method != END_EFFECTORS:
        return examples_of(annotated, EnergyMethod(method))
    return [
        Example(end_effector_candidates(clip.track, clip.beats), clip.true) for clip in annotated
    ]


def _judged(
    method: str,
    examples: Sequence[Example],
    counts: Counts,
    learned: Thresholds,
    tolerance: float,
) -> JudgedKeyposes:
    usual = (
        match(example.candidates.times(USUAL.t1, USUAL.t2), example.true, tolerance)
        for example in examples
    )
    return JudgedKeyposes(
        method=method,
        counts=counts,
        usual=total(usual),
        learned=learned,
        t1=curve_of_t1(examples, learned.t2, tolerance),
        t2=curve_of_t2(examples, learned.t1, tolerance),
    )
