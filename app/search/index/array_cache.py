"""Descriptors of clips, loaded when a search needs them; the bytes in memory are bounded."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable, Iterator

from app.numerics.arrays import FloatArray
from app.search.index import usable_arrays
from app.store.store import Store

_Key = tuple[str, str]


class ArrayCache:
    """Arrays by (clip id, name); the least recently used are dropped first.

    The cache does not notice that a clip changes: the index calls `forget` when it does.
    """

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._forgotten = 0
        self._kept: OrderedDict[_Key, FloatArray] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def cached_bytes(self) -> int:
        """Bytes of the arrays in memory."""
        return self._bytes

    def get_many(self, store: Store, clip_ids: Iterable[str], name: str) -> dict[str, FloatArray]:
        """One array of many clips, by clip id; clips without a usable one are left out."""
        found: dict[str, FloatArray] = {}
        missing: list[str] = []
        with self._lock:
            forgotten = self._forgotten
            for clip_id in clip_ids:
                array = self._kept.get((clip_id, name))
                if array is None:
                    missing.append(clip_id)
                else:
                    self._kept.move_to_end((clip_id, name))
                    found[clip_id] = array
        if missing:
            with store.read() as tx:
                loaded = usable_arrays.get_many(tx, missing, name)
            self._keep(name, loaded, forgotten)
            found |= loaded
        return found

    def forget(self, clip_ids: Iterable[str]) -> None:
        """Drop all arrays of these clips."""
        with self._lock:
            self._forgotten += 1
            gone = set(clip_ids)
            for key in list(self._of(gone)):
                self._bytes -= self._kept.pop(key).nbytes

    def _of(self, clip_ids: set[str]) -> Iterator[_Key]:
        return (key for key in self._kept if key[0] in clip_ids)

    def _keep(self, name: str, loaded: dict[str, FloatArray], forgotten: int) -> None:
        with self._lock:
            if forgotten != self._forgotten:
                return  # a clip changed during the load: these arrays may be old
            for clip_id, array in loaded.items():
                before = self._kept.pop((clip_id, name), None)
                self._bytes += array.nbytes - (0 if before is None else before.nbytes)
                self._kept[clip_id, name] = array
            while self._bytes > self._max_bytes and self._kept:
                _, dropped = self._kept.popitem(last=False)
                self._bytes -= dropped.nbytes
