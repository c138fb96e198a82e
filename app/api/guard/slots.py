"""How many bodies may be received at once, so that their files do not fill the disk.

Where no slot is free, the slowest body leaves for a new one, if it is slow (see `arrival`): slow
clients hold no slot for longer than a moment while others want one.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from app.api.failures.problems import TooBusy
from app.api.guard.arrival import Arrival


class Slots:
    """Slots for bodies of one kind; used by one event loop only, so there is no lock."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._held: set[Arrival] = set()

    @contextmanager
    def one(self, arrival: Arrival) -> Iterator[None]:
        """Hold a slot for the block. Raises TooBusy where none is free and no body is slow."""
        if len(self._held) >= self._most:
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
