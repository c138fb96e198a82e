"""How likely a synthesized motion is a hit, learned from motions that were held out.

A logistic curve over the number of given persons or tasks, over whether the motion follows a single
take, and over whether the nearest real clip of others shows the task. Shares of single rows of
trials were used before: with 32 trials a row they rose and fell by chance. More given takes never
lower the expectation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from app.numerics.arrays import FloatArray

RIDGE = 1.0
"""Penalty of the squared weights (not of the constant), so that few trials give a flat curve."""

BINS = 5
"""The largest number of groups, of equal size, whose expectation is compared with their hits."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """A synthesized motion whose cell was held out.

    person: of the cell; given: number of persons, or of tasks, from which it was made; follows:
    whether it follows a single take; shows_task: whether the real clip nearest to it, without
    those of the cell, shows the task; is_hit: whether the nearest real clip is of the cell.
    """

    person: str
    given: int
    follows: bool
    shows_task: bool
    is_hit: bool


@dataclass(frozen=True, slots=True)
class ExpectedHits:
    """The fitted curve.

    weights: (4,) of the constant, of the logarithm of `given`, of `follows` and of `shows_task`.
    most: the largest number of given persons or tasks that was tried; more count as this many.
    trials: the number of outcomes.
    """

    weights: tuple[float, ...]
    most: int
    trials: int

    def of(self, given: int, *, follows: bool, shows_task: bool) -> float:
        """The expected share of hits, 0..1, of motions like this one; given: 1 or more."""
        row = _features([Outcome("", min(given, self.most), follows, shows_task, is_hit=False)])
        return float(scipy.special.expit(row @ np.array(self.weights))[0])

    def to_json(self) -> dict[str, Any]:
        """For `from_json`."""
        return {"weights": list(self.weights), "most": self.most, "trials": self.trials}

    @classmethod
    def from_json(cls, stored: dict[str, Any]) -> ExpectedHits:
        """The curve from the result of `to_json`. Raises KeyError."""
        return cls(tuple(stored["weights"]), int(stored["most"]), int(stored["trials"]))


def fit_expected_hits(outcomes: Sequence[Outcome]) -> ExpectedHits:
    """The likeliest curve for at least one outcome."""
    rows = _features(outcomes)
    hits = np.array([one.is_hit for one in outcomes], dtype=np.float64)
    penalty = np.array([0.0, RIDGE, RIDGE, RIDGE])

    def loss(weights: FloatArray) -> tuple[float, FloatArray]:
        z = rows @ weights
        value = np.logaddexp(0.0, z).sum() - hits @ z + 0.5 * penalty @ weights**2
        return float(value), rows.T @ (scipy.special.expit(z) - hits) + penalty * weights

    # The bounds keep the constant finite if all outcomes are equal, and the curve rising.
    bounds = [(-6.0, 6.0), (0.0, None), (None, None), (None, None)]
    found = scipy.optimize.minimize(loss, np.zeros(4), jac=True, bounds=bounds, method="L-BFGS-B")
    most = max(one.given for one in outcomes)
    return ExpectedHits(tuple(float(weight) for weight in found.x), most, len(outcomes))


def reliability(outcomes: Sequence[Outcome]) -> list[dict[str, float]]:
    """What the curve says and what is seen, in groups of rising expectation.

    Each outcome is judged by a curve of the other persons' outcomes. Each row has "trials", "said"
    (mean expectation) and "seen" (share of hits). Empty with fewer than two persons.
    """
    persons = sorted({one.person for one in outcomes})
    if len(persons) < 2:
        return []
    said, seen = [], []
    for person in persons:
        curve = fit_expected_hits([one for one in outcomes if one.person != person])
        for one in outcomes:
            if one.person == person:
                said.append(curve.of(one.given, follows=one.follows, shows_task=one.shows_task))
                seen.append(float(one.is_hit))
    order = np.argsort(said, kind="stable")
    groups = [group for group in np.array_split(order, BINS) if len(group)]
    return [
        {
            "trials": len(group),
            "said": round(float(np.array(said)[group].mean()), 4),
            "seen": round(float(np.array(seen)[group].mean()), 4),
        }
        for group in groups
    ]


def _features(outcomes: Sequence[Outcome]) -> FloatArray:
    """(n, 4) the numbers that are weighted."""
    rows = [(1.0, np.log(one.given), one.follows, one.shows_task) for one in outcomes]
    return np.array(rows, dtype=np.float64)
