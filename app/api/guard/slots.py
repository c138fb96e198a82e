"""A limit on the bodies that are received at once, so that their files do not fill the disk.

If no slot is free, the slowest body loses its slot to the new body, if it is slow (see
`arrival`). So slow clients do not block the slots while other clients wait.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from app.api.failures.problems import TooBusy
from app.api.guard.arrival import Arrival


class Slots:
    """Slots for bodies of one kind. Only one event loop uses them, so there is no lock."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._held: set[Arrival] = set()

    @contextmanager
    def one(self, arrival: Arrival) -> Iterator[None]:
        """Hold a slot for the block. Raises TooBusy if no slot is free and no body is slow."""
        if len(self._held) >= self._limit:
            self._free_one()
        self._held.add(arrival)
        try:
            yield
        finally:
            self._held.discard(arrival)

    def _free_one(self) -> None:
        slow = [arrival for arrival in self._held if arrival.is_slow()]
        if not slow:
            raise TooBusy
        slowest = max(slow, key=lambda arrival: arrival.behind())
        self._held.discard(slowest)
        slowest.give_up()
