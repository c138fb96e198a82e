"""Thresholds are learned from annotated motions, and judged on those that did not teach them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pytest

from app.analysis.keyposes.keyposes import find_candidates
from app.models.keyposes.matching import total
from app.models.keyposes.thresholds import (
    USUAL,
    Example,
    KeyposeThresholds,
    Thresholds,
    curve_of_t1,
    curve_of_t2,
    threshold_grid,
)
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of
from tests.dances import dance


@dataclass(frozen=True)
class Known:
    """Rests at whole seconds, with these energies and drops."""

    energies: tuple[float, ...]
    drops: tuple[float, ...]

    def times(self, t1: float, t2: float) -> FloatArray:
        passing = (np.array(self.energies) < t1) | (np.array(self.drops) > t2)
        return np.flatnonzero(passing).astype(float)


SMALL = Example(Known((0.35, 0.38, 0.55, 0.7), (0.2,) * 4), np.array([0.0, 1.0]))
"""Its keyposes are told by T1 alone, and only by a larger one than usual."""

DEEP = Example(Known((0.9, 0.9, 0.9), (0.45, 0.48, 0.55)), np.array([2.0]))
"""Its keypose is told by T2 alone, and only by a smaller one than usual."""


def test_the_thresholds_of_the_examples_are_learned() -> None:
    assert threshold_grid([SMALL]).learned() == Thresholds(0.4, USUAL.t2)
    assert threshold_grid([DEEP]).learned() == Thresholds(USUAL.t1, 0.5)
    assert threshold_grid([SMALL, DEEP]).learned() == Thresholds(0.4, 0.5)


def test_the_usual_thresholds_stay_without_examples_or_differences() -> None:
    assert threshold_grid([]).learned() == USUAL
    assert (
        threshold_grid([Example(Known((0.0, 0.0), (9.0, 9.0)), np.array([0.0, 1.0]))]).learned()
        == USUAL
    )


def test_a_clip_is_judged_with_thresholds_from_the_other_clips() -> None:
    (pair, counts), _ = threshold_grid([SMALL, DEEP]).held_out(["one", "two"])
    assert pair == Thresholds(USUAL.t1, 0.5)
    assert (counts.true, counts.found) == (2, 0)
    together = threshold_grid([SMALL, SMALL, DEEP]).held_out(["one", "one", "two"])
    assert together[0][0] == pair  # the copy in its own group taught nothing
    apart = threshold_grid([SMALL, SMALL, DEEP]).held_out(["one", "three", "two"])
    assert apart[0][0] == Thresholds(0.4, 0.5)
    assert apart[0][1].f == 1.0
    assert threshold_grid([SMALL]).held_out(["alone"])[0][0] == USUAL


def test_the_curves_are_those_of_figures_4_and_5() -> None:
    curve = curve_of_t1([SMALL, DEEP], t2=0.5)
    at = curve.values.tolist().index
    assert (curve.recall[at(0.0)], curve.precision[at(0.0)]) == (pytest.approx(1 / 3), 1.0)
    assert (curve.recall[at(0.4)], curve.precision[at(0.4)]) == (1.0, 1.0)
    assert curve.precision[at(1.0)] == pytest.approx(3 / 7)
    assert (np.diff(curve.recall) >= 0).all()
    deep = curve_of_t2([SMALL, DEEP], t1=0.4)
    assert (np.diff(deep.recall) <= 0).all()
    assert deep.precision[0] == pytest.approx(3 / 7)
    assert deep.recall[-1] == pytest.approx(2 / 3)


@lru_cache(maxsize=1)
def annotated() -> list[Example]:
    made = [dance(200 + seed, tempo, noise=0.01) for seed, tempo in enumerate((70, 90, 110, 130))]
    return [
        Example(find_candidates(body_track(motion_of(d.positions, d.rate)), beats=d.beats), d.stops)
        for d in made
    ]


def test_thresholds_learned_from_dances_work_for_other_dances() -> None:
    examples = annotated()
    judged = total(counts for _, counts in threshold_grid(examples).held_out(list("abcd")))
    assert judged.f > 0.97
    curve = curve_of_t1(examples, USUAL.t2)
    wide = (curve.values >= 0.2) & (curve.values <= 0.4)
    assert curve.recall[wide].min() > 0.95
    assert curve.precision[wide].min() > 0.95


def test_a_stored_model_is_read_back() -> None:
    model = KeyposeThresholds({"rms": Thresholds(0.3, 0.8), "printed": USUAL})
    assert KeyposeThresholds.from_arrays(*model.to_arrays()) == model
    with pytest.raises(KeyError):
        KeyposeThresholds.from_arrays({}, {"rms": {"t1": 0.3}})
