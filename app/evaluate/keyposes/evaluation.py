"""Keyposes against those that people named: Table 1 and figures 4 and 5 of Perera 2009.

Thresholds are those that the other recordings teach, so that no clip is judged by what it
taught; the usual ones stand beside them, and beside the energies the method by hands and
feet that Perera compares with.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.analysis.energy.energy import EnergyMethod
from app.analysis.keyposes.end_effectors import end_effector_candidates
from app.errors import NotEnoughLabels
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
from app.services.training.keypose_learning import NOBODY, examples_of
from app.store.clips.filter import ClipFilter

END_EFFECTORS = "end-effectors"
JUDGED_KEYPOSES = (*(method.value for method in EnergyMethod), END_EFFECTORS)
"""The energies, and what Perera compares with."""

HOW = (
    f"{NOBODY} Name some with PUT /v1/clips/{{id}}/keyposes, or in the column `keyposes` of a "
    "manifest."
)


@dataclass(frozen=True, slots=True)
class JudgedClip:
    """A line of Table 1: how many keyposes a clip has, and of each method what it found."""

    clip_id: str
    name: str
    task: str | None
    true: int
    counts: Mapping[str, Counts]


@dataclass(frozen=True, slots=True)
class JudgedKeyposes:
    """One method over all clips.

    counts: with thresholds that the other recordings taught; usual: with the usual ones;
    learned: what all clips together teach; t1, t2: the curves of figs 4 and 5, the other
    threshold held at what was learned.
    """

    method: str
    counts: Counts
    usual: Counts
    learned: Thresholds
    t1: ThresholdCurve
    t2: ThresholdCurve


@dataclass(frozen=True, slots=True)
class KeyposeEvaluation:
    """tolerance: seconds by which a keypose may be missed; recordings: how many taught."""

    tolerance: float
    recordings: int
    clips: tuple[JudgedClip, ...]
    methods: tuple[JudgedKeyposes, ...]


def is_any_annotated(lib: Library, filter: ClipFilter | None = None) -> bool:
    """Whether there is anything to judge."""
    return bool(annotated_ids(lib.store, filter))


def judge_keyposes(
    lib: Library, filter: ClipFilter | None = None, tolerance: float = TOLERANCE
) -> KeyposeEvaluation:
    """Every annotated clip that passes the filter. Raises BadField, NotEnoughLabels."""
    if not 0 < tolerance <= 1:
        raise fields.bad_field("tolerance", "must be above 0 and at most 1 s")
    annotated = read_annotated(lib.store, filter)
    if not annotated:
        raise NotEnoughLabels(HOW)
    groups = [clip.group for clip in annotated]
    examples = {method: _examples(annotated, method) for method in JUDGED_KEYPOSES}
    lessons = {method: threshold_grid(some, tolerance) for method, some in examples.items()}
    counts = {
        method: [found for _, found in taught.held_out(groups)]
        for method, taught in lessons.items()
    }
    return KeyposeEvaluation(
        tolerance=tolerance,
        recordings=len(set(groups)),
        clips=tuple(
            JudgedClip(
                clip_id=clip.clip.id,
                name=clip.clip.name,
                task=clip.clip.task,
                true=len(clip.true),
                counts={method: counts[method][place] for method in JUDGED_KEYPOSES},
            )
            for place, clip in enumerate(annotated)
        ),
        methods=tuple(
            _judged(method, some, total(counts[method]), lessons[method].learned(), tolerance)
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
