"""Matches found keyposes with true ones (Perera 2009, Table 1), for precision and recall."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from app.numerics.arrays import FloatArray

TOLERANCE = 0.1
"""Largest distance in seconds of a found keypose from the true one."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of keyposes: true ones, found ones, and found ones that match a true one."""

    true: int
    found: int
    correct: int

    @property
    def precision(self) -> float:
        """Share of the found keyposes that are correct (section 3.3); 0 if none was found."""
        return self.correct / self.found if self.found else 0.0

    @property
    def recall(self) -> float:
        """Share of the true keyposes that were found (section 3.3); 0 if there are none."""
        return self.correct / self.true if self.true else 0.0

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall; 1 if there are no true and no found ones."""
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
    """Pair the times (seconds) one to one; pairs are at most `within` seconds apart.

    The number of pairs is the largest possible. found: (n,), true: (m,).
    """
    times, meant = sorted(found.tolist()), sorted(true.tolist())
    at = correct = 0
    for time in times:
        # the earliest free time is the best choice, since later ones stay free for later times
        while at < len(meant) and meant[at] < time - within:
            at += 1
        if at < len(meant) and meant[at] <= time + within:
            at += 1
            correct += 1
    return Counts(len(meant), len(times), correct)
