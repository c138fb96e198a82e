"""Keyposes found against keyposes meant: Table 1 of Perera 2009, and what follows from it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from app.numerics.arrays import FloatArray

TOLERANCE = 0.1
"""Seconds by which a keypose may be missed and is still the same."""


@dataclass(frozen=True, slots=True)
class Counts:
    """How many keyposes there are, were found, and were found where there are any."""

    true: int
    found: int
    correct: int

    @property
    def precision(self) -> float:
        """Share of what was found that is right (section 3.3); 0 where nothing was found."""
        return self.correct / self.found if self.found else 0.0

    @property
    def recall(self) -> float:
        """Share of the true ones that was found (section 3.3); 0 where there are none."""
        return self.correct / self.true if self.true else 0.0

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall; 1 where none are true and none were found."""
        both = self.found + self.true
        return 2 * self.correct / both if both else 1.0


def total(counts: Iterable[Counts]) -> Counts:
    """Of several clips together."""
    listed = tuple(counts)
    return Counts(
        true=sum(each.true for each in listed),
        found=sum(each.found for each in listed),
        correct=sum(each.correct for each in listed),
    )


def match(found: FloatArray, true: FloatArray, within: float = TOLERANCE) -> Counts:
    """Pair times (seconds) one to one, as many as can be, none further apart than `within`."""
    times, meant = sorted(found.tolist()), sorted(true.tolist())
    at = correct = 0
    for time in times:
        # The earliest that is left will do: whoever comes later has the later ones.
        while at < len(meant) and meant[at] < time - within:
            at += 1
        if at < len(meant) and meant[at] <= time + within:
            at += 1
            correct += 1
    return Counts(len(meant), len(times), correct)
