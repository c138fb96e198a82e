"""The JSON of clips that searches showed, for the next search that finds them.

To read the rows of a thousand clips and to write them as JSON takes longer than to find the clips.
A search reads only how each clip is now (`partial.shown_states`), by one query of a few columns. If
the clip is as it was, its text is still right. Only this query says which clips exist and who may
see them, so a text is never given for a clip that the key of a call hides.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Collection, Mapping
from functools import partial as bound

from app.store.clips import partial
from app.store.clips.partial import PartialClip, ShownState
from app.store.database.engine import Tx

MAX_BYTES = 64 * 2**20
"""Memory of the texts; those that were not used for the longest time go first. A whole clip of the
benches takes 1.4 kB, so that about 47,000 clips stay; more roles and labels take more."""
OVERHEAD = 700
"""Bytes of an entry beside its text (measured by tracemalloc on 20,000 entries: 711)."""

Key = tuple[frozenset[str], str]
"""The fields that are shown, and the id of the clip."""


class KeptClips:
    """Texts of clips by their fields, id and state. Threads may share it."""

    def __init__(self, max_bytes: int = MAX_BYTES) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._kept: OrderedDict[Key, tuple[ShownState, PartialClip]] = OrderedDict()
        self._lock = threading.Lock()

    def read(
        self, tx: Tx, clip_ids: Collection[str], names: frozenset[str]
    ) -> dict[str, PartialClip]:
        """The clips that exist among `clip_ids`, by id, with the fields `names` and `duration`.

        A clip that was shown with these fields has its `text` instead of the values.
        """
        if names <= partial.PLAIN:  # read as fast as the states
            return partial.read(tx, clip_ids, {"duration", *names})
        # States come first: a text that is newer than its state is only made once more.
        states = partial.shown_states(tx, clip_ids)
        found = self._get(names, states)
        missing = [clip_id for clip_id in clip_ids if clip_id not in found]
        if missing:
            read = partial.read(tx, missing, {"duration", *names})
            for clip_id, clip in read.items():
                if clip_id in states:
                    clip.keep = bound(self._put, (names, clip_id), states[clip_id], clip.duration)
            found |= read
        return found

    def _get(
        self, names: frozenset[str], states: Mapping[str, ShownState]
    ) -> dict[str, PartialClip]:
        found = {}
        with self._lock:
            for clip_id, state in states.items():
                kept = self._kept.get((names, clip_id))
                if kept is not None and kept[0] == state:
                    self._kept.move_to_end((names, clip_id))
                    found[clip_id] = kept[1]
        return found

    def _put(self, key: Key, state: ShownState, duration: float | None, text: bytes) -> None:
        clip = PartialClip({"id": key[1], "duration": duration}, text)
        with self._lock:
            self._drop(key)
            self._kept[key] = state, clip
            self._bytes += OVERHEAD + len(text)
            while self._bytes > self._max_bytes:
                self._drop(next(iter(self._kept)))

    def _drop(self, key: Key) -> None:
        gone = self._kept.pop(key, None)
        if gone is not None:
            self._bytes -= OVERHEAD + len(gone[1].text or b"")
