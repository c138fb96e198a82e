"""A cache of descriptors of clips, with a limit on its bytes."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Sequence

from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.store.store import Store

_Key = tuple[str, str]


class ArrayCache:
    """Arrays by (clip id, name); the least recently used are dropped first.

    The cache does not notice that a clip changes. So the index calls `forget` for each change.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._forgotten = 0  # the number of calls of `forget`
        self._cached: OrderedDict[_Key, FloatArray] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def cached_bytes(self) -> int:
        """Bytes of the arrays in memory."""
        return self._bytes

    def get_many(self, store: Store, clip_ids: Iterable[str], name: str) -> dict[str, FloatArray]:
        """One array of many clips, by clip id; clips without a usable array are left out."""

        def load(missing: Sequence[str]) -> dict[str, FloatArray]:
            with store.read() as tx:
                return usable_arrays.get_many(tx, missing, name)

        return self.get_made(clip_ids, name, load)

    def get_made(
        self,
        clip_ids: Iterable[str],
        name: str,
        make: Callable[[Sequence[str]], dict[str, FloatArray]],
    ) -> dict[str, FloatArray]:
        """As `get_many`, of arrays that `make` returns for the clips that are not in memory."""
        cached: dict[str, FloatArray] = {}
        missing: list[str] = []
        with self._lock:
            forgotten = self._forgotten
            for clip_id in clip_ids:
                array = self._cached.get((clip_id, name))
                if array is None:
                    missing.append(clip_id)
                else:
                    self._cached.move_to_end((clip_id, name))
                    cached[clip_id] = array
        if missing:
            loaded = make(missing)
            self._add(name, loaded, forgotten)
            cached |= loaded
        return cached

    def forget(self, clip_ids: Iterable[str]) -> None:
        """Drop all arrays of these clips."""
        with self._lock:
            self._forgotten += 1
            gone = set(clip_ids)
            for key in list(self._of(gone)):
                self._bytes -= self._cached.pop(key).nbytes

    def _of(self, clip_ids: set[str]) -> Iterator[_Key]:
        return (key for key in self._cached if key[0] in clip_ids)

    def _add(self, name: str, loaded: dict[str, FloatArray], forgotten: int) -> None:
        with self._lock:
            if forgotten != self._forgotten:
                return  # a clip changed during the load: these arrays may be old
            for clip_id, array in loaded.items():
                before = self._cached.pop((clip_id, name), None)
                self._bytes += array.nbytes - (0 if before is None else before.nbytes)
                self._cached[clip_id, name] = array
            while self._bytes > self._max_bytes and self._cached:
                _, dropped = self._cached.popitem(last=False)
                self._bytes -= dropped.nbytes
