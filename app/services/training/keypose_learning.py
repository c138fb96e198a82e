"""Learns the keypose thresholds of each energy method from clips that people annotated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from app.analysis.energy.energy import EnergyMethod
from app.analysis.keyposes.keyposes import find_candidates
from app.errors import NotEnoughLabels
from app.models.keyposes.matching import TOLERANCE, Counts, match, total
from app.models.keyposes.thresholds import (
    USUAL,
    Example,
    KeyposeThresholds,
    ThresholdGrid,
    threshold_grid,
)
from app.services.training.annotated import AnnotatedClip

NO_ANNOTATED_CLIP = "No ready clip has keyposes that a person annotated."


def learn_keyposes(
    annotated: Sequence[AnnotatedClip],
) -> tuple[KeyposeThresholds, dict[str, Any]]:
    """Learn the thresholds that find the annotated keyposes best; returns figures as JSON too.

    The figures of each method are of two kinds: "learned", of thresholds that were learned from the
    other recordings, and "usual", of the default thresholds. Raises NotEnoughLabels without
    annotated clips.
    """
    if not annotated:
        raise NotEnoughLabels(NO_ANNOTATED_CLIP)
    groups = [clip.group for clip in annotated]
    learned, figures = {}, {}
    for method in EnergyMethod:
        examples = examples_of(annotated, method)
        grid = threshold_grid(examples)
        learned[method.value] = grid.learned()
        figures[method.value] = _figures(examples, grid, groups)
    return KeyposeThresholds(learned), _framed(figures, groups)


def examples_of(annotated: Sequence[AnnotatedClip], method: EnergyMethod) -> list[Example]:
    """The candidates of each clip by the energy method, with the annotated times."""
    return [
        Example(find_candidates(clip.track, method=method, beats=clip.beats), clip.true)
        for clip in annotated
    ]


def counts_document(counts: Counts) -> dict[str, Any]:
    """The counts with precision, recall and F, for JSON."""
    shares = {"precision": counts.precision, "recall": counts.recall, "f": counts.f}
    return asdict(counts) | shares


def _figures(
    examples: Sequence[Example], grid: ThresholdGrid, groups: Sequence[str]
) -> dict[str, Any]:
    usual = total(
        match(example.candidates.times(USUAL.t1, USUAL.t2), example.true) for example in examples
    )
    figures = {"usual": counts_document(usual)}
    if len(set(groups)) > 1:
        figures["learned"] = counts_document(total(counts for _, counts in grid.held_out(groups)))
    return figures


def _framed(figures: dict[str, Any], groups: Sequence[str]) -> dict[str, Any]:
    framed = {"clips": len(groups), "tolerance": TOLERANCE, "methods": figures}
    if len(set(groups)) < 2:
        framed["reason"] = "Held-out figures need two annotated recordings."
    return framed
