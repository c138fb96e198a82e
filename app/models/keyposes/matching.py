"""Matches detected keyposes with true ones (Perera 2009, Table 1), for precision and recall."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from app.numerics.arrays import FloatArray

TOLERANCE = 0.1
"""Largest distance, in seconds, of a detected keypose from the true one."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of keyposes: true ones, detected ones (`found`), and correctly detected ones."""

    true: int
    found: int
    correct: int

    @property
    def precision(self) -> float:
        """Share of the detected keyposes that are correct (section 3.3); 0 if none is detected."""
        return self.correct / self.found if self.found else 0.0

    @property
    def recall(self) -> float:
        """Share of the true keyposes that were detected (section 3.3); 0 without true ones."""
        return self.correct / self.true if self.true else 0.0

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall; 1 without true and detected keyposes."""
        both = self.found + self.true
        return 2 * self.correct / both if both else 1.0


def total(counts: Iterable[Counts]) -> Counts:
    """The sums of the counts of several clips."""
    listed = tuple(counts)
    return Counts(
        true=sum(each.true for each in listed),
        found=sum(each.found for each in listed),
        correct=sum(each.correct for each in listed),
    )


def match(found: FloatArray, true: FloatArray, within: float = TOLERANCE) -> Counts:
    """Pair detected and true times one to one; pairs are at most `within` seconds apart.

    The number of pairs is the largest possible. found: (n,) detected times, true: (m,) true
    times, both in seconds and in any order.
    """
    times, true_times = sorted(found.tolist()), sorted(true.tolist())
    at = correct = 0
    for time in times:
        # the earliest free time is the best choice, since later ones stay free for later times
        while at < len(true_times) and true_times[at] < time - within:
            at += 1
        if at < len(true_times) and true_times[at] <= time + within:
            at += 1
            correct += 1
    return Counts(len(true_times), len(times), correct)
