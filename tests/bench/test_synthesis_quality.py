"""Whether what is said about a synthesized motion is true: its expected hit, jerk and foot skate.

The ways in which the expected hit depends on a motion were chosen on these clips, by their Brier
score with persons held out (see `expected_hits`). The weights are not: each motion is judged by
weights of the other persons' motions.

Run: pytest -m bench -s tests/bench/test_synthesis_quality.py
"""

from __future__ import annotations

import numpy as np
import pytest

from app.models.held_out.expected_hits import reliability
from app.models.held_out.synthesis import NEW_TASK, draw_trials, judge_trials
from app.services.synthesis.movement import Movement, doubts, movement_of
from tests.bench.made_motions import Clip, fitted, made, real_motions
from tests.bench.page import Section

FIGURES = Section(
    "synthesis_quality",
    "What is said about motions that were not recorded",
    trials="combinations of person and task left out, at most 100 for each number of given takes",
)

pytestmark = pytest.mark.bench

EVERY_CELL = 10_000
MADE = 40
"""Number of motions that are made completely, beside all dashes."""


@pytest.fixture(scope="module")
def real() -> list[Clip]:
    return real_motions()


@pytest.mark.parametrize("source", ["", "bandai-namco-1", "bandai-namco-2"])
def test_expected_hits_are_those_that_are_seen(real: list[Clip], source: str) -> None:
    """Each motion is judged by a curve that was learned from the other persons' motions."""
    clips = [clip for clip in real if clip.path.startswith(source)]
    judged = judge_trials(fitted(clips), 100)
    FIGURES.print(f"\nexpected and seen hits, {source or 'all real clips'}, persons held out:")
    for kind, results in judged.items():
        rows = reliability([one.outcome for one in results])
        shown = "  ".join(
            f"{row['said']:.2f} said, {row['seen']:.2f} seen of {row['trials']}" for row in rows
        )
        apart = [abs(row["said"] - row["seen"]) * row["trials"] for row in rows]
        error = sum(apart) / len(results)
        FIGURES.print(f"  {kind:11} {shown}; mean difference {error:.3f}")
        assert error < 0.12


def test_jerk_and_skate_of_made_motions(real: list[Clip]) -> None:
    """Motions of the tasks of dataset 1, which has the dash, beside all real takes of each."""
    clips = [clip for clip in real if clip.path.startswith("bandai-namco-1")]
    record = fitted(clips)
    trials = draw_trials(record, NEW_TASK, 3, MADE)
    dash = [one for one in draw_trials(record, NEW_TASK, 3, EVERY_CELL) if one.task == "dash"]
    rows = []
    for trial in {(one.person, one.task): one for one in (*trials, *dash)}.values():
        own = movement_of(made(record, clips, NEW_TASK, trial))
        takes = [movement_of(clip.motion) for clip in clips if clip.task == trial.task]
        real_ones = Movement(
            float(np.mean([take.skate for take in takes])),
            float(np.mean([take.jerk for take in takes])),
        )
        rows.append((trial, own, real_ones, doubts(own, real_ones, trial.task)))
    doubted = [row for row in rows if row[3]]
    FIGURES.print(f"\njerk and skate beyond twice the real ones: {len(doubted)} of {len(rows)}")
    for trial, own, real_ones, _ in doubted:
        FIGURES.print(
            f"  {trial.person} {trial.task}: jerk {own.jerk:.0f} (real {real_ones.jerk:.0f}) m/s3,"
            f" skate {own.skate:.2f} (real {real_ones.skate:.2f}) m/s"
        )
    ratios = np.array([(own.jerk / r.jerk, own.skate / r.skate) for _, own, r, _ in rows])
    low, middle, high = np.quantile(ratios, (0.1, 0.5, 0.9), axis=0)
    for place, name in enumerate(("jerk", "skate")):
        FIGURES.print(
            f"  {name} by that of real takes: median {middle[place]:.2f},"
            f" 10 to 90 %: {low[place]:.2f} to {high[place]:.2f}"
        )
    assert len(doubted) < 0.5 * len(rows)
