"""Thresholds of keyposes from the clips that people annotated, each method its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from app.analysis.energy import EnergyMethod
from app.analysis.keyposes import find_candidates
from app.errors import NotEnoughLabels
from app.models.keypose_matching import TOLERANCE, Counts, match, total
from app.models.keypose_thresholds import USUAL, Example, KeyposeThresholds, held_out, learn
from app.services.annotated import AnnotatedClip

NOBODY = "No ready clip carries keyposes that a person named."


def learn_keyposes(annotated: Sequence[AnnotatedClip]) -> KeyposeThresholds:
    """The thresholds under which most of what people named is found. Raises NotEnoughLabels."""
    if not annotated:
        raise NotEnoughLabels(NOBODY)
    return KeyposeThresholds(
        {method.value: learn(examples_of(annotated, method)) for method in EnergyMethod}
    )


def keypose_figures(annotated: Sequence[AnnotatedClip]) -> dict[str, Any]:
    """How well thresholds find keyposes in clips that taught them nothing; JSON.

    By method: `learned` on the other recordings, beside the `usual` ones.
    """
    found: dict[str, Any] = {
        "clips": len(annotated),
        "tolerance": TOLERANCE,
        "methods": {
            method.value: _figures(examples_of(annotated, method), annotated)
            for method in EnergyMethod
        },
    }
    if len({clip.group for clip in annotated}) < 2:
        found["reason"] = "Thresholds can be held out from two annotated recordings on."
    return found


def examples_of(annotated: Sequence[AnnotatedClip], method: EnergyMethod) -> list[Example]:
    """The candidates of each clip by that energy, with what is true."""
    return [Example(find_candidates(clip.track, method=method), clip.true) for clip in annotated]


def _figures(examples: Sequence[Example], annotated: Sequence[AnnotatedClip]) -> dict[str, Any]:
    groups = [clip.group for clip in annotated]
    usual = total(
        match(example.candidates.times(USUAL.t1, USUAL.t2), example.true) for example in examples
    )
    figures = {"usual": told(usual)}
    if len(set(groups)) > 1:
        figures["learned"] = told(total(counts for _, counts in held_out(examples, groups)))
    return figures


def told(counts: Counts) -> dict[str, Any]:
    """Counts with what follows from them, for JSON."""
    shares = {"precision": counts.precision, "recall": counts.recall, "f": counts.f}
    return asdict(counts) | shares
