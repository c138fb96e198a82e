"""The quarantine in a bucket: objects below `quarantine/`.

The time of an object is the store's, and nobody can change it. So a purge counts time by the
store's clock, and from the last moment at which that clock went on as it should: after a jump, or a
pause of more than MAX_PURGE_GAP_S, the whole retention begins again. No file is removed too early.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import suppress

from app.errors import NotFound
from app.store.files.objects import ObjectInfo, Objects
from app.store.files.quarantine import FOLDER, MAX_PURGE_GAP_S, NAME_LENGTH, QuarantineContent

_MARK = f"{FOLDER}/last-purge"


class ObjectQuarantine:
    """Objects by SHA-256, which the database does not name."""

    def __init__(self, objects: Objects, place: str) -> None:
        self._objects = objects
        self.name = f"{place}/{FOLDER}"

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file here."""
        return (name_here(one) for one in self._files())

    def has(self, sha256: str) -> bool:
        """Whether a file is here."""
        return self._objects.find(f"{FOLDER}/{sha256}") is not None

    def take(self, name: str, sha256: str) -> None:
        """Moves an object of the store here."""
        self._objects.copy(name, f"{FOLDER}/{sha256}")
        self._objects.remove(name)

    def give_back(self, name: str, sha256: str) -> bool:
        """Moves a file back to its name in the store; returns whether it was here."""
        try:
            self._objects.copy(f"{FOLDER}/{sha256}", name)
        except NotFound:
            return False
        self.remove(sha256)
        return True

    def remove(self, sha256: str) -> None:
        """Removes a file, if it is here."""
        self._objects.remove(f"{FOLDER}/{sha256}")

    def purge(self, older_than_s: float) -> tuple[str, ...]:
        """As `Quarantine.purge`. Raises StorageError."""
        files = list(self._files())
        if not files:
            return ()
        now, since = self._count_on()
        # A file came when its object was written, but counts from `since` at the earliest.
        old = [one for one in files if now - max(one.modified.timestamp(), since) > older_than_s]
        for one in old:
            self._objects.remove(one.name)
        return tuple(name_here(one) for one in old)

    def content(self) -> QuarantineContent:
        """The names, the size and the age of all files here."""
        files = list(self._files())
        oldest = min((one.modified.timestamp() for one in files), default=None)
        names = tuple(sorted(name_here(one) for one in files))
        return QuarantineContent(names, sum(one.size for one in files), oldest)

    def _count_on(self) -> tuple[float, float]:
        """Marks this purge; returns the store's time, and from when time counts."""
        before, since = self._last()
        now = self._mark(since)
        if before is None or not 0.0 <= now - before <= MAX_PURGE_GAP_S:
            since = now
            self._mark(since)
        return now, since

    def _last(self) -> tuple[float | None, float]:
        mark = self._objects.find(_MARK)
        if mark is None:
            return None, 0.0
        with suppress(NotFound, ValueError, TypeError, KeyError):
            content = json.loads(b"".join(self._objects.read(_MARK)))
            return mark.modified.timestamp(), float(content["since"])
        return None, 0.0

    def _mark(self, since: float) -> float:
        self._objects.replace(_MARK, json.dumps({"since": since}).encode())
        mark = self._objects.find(_MARK)
        return since if mark is None else mark.modified.timestamp()

    def _files(self) -> Iterator[ObjectInfo]:
        return (one for one in self._objects.below(FOLDER) if len(name_here(one)) == NAME_LENGTH)


def name_here(one: ObjectInfo) -> str:
    """The last part of the name of an object."""
    return one.name.rpartition("/")[2]
