"""The sweep of the folder of files: it finishes removals and fills the quarantine.

A sweep deletes only three kinds of files: recorded removals, temporary files of dead processes, and
files that were in the quarantine for the whole retention. A stored file that the database does not
name goes to the quarantine. So an operator may restore the database and the files in any order.
"""

from __future__ import annotations

import logging
from collections.abc import Collection
from dataclasses import dataclass

from app.errors import StorageError
from app.store.clips.repository import in_batches
from app.store.files.quarantine import DAY_S
from app.store.jobs import references
from app.store.store import Store

_log = logging.getLogger(__name__)

BATCH = 100
"""Files that are moved in one transaction; more would make other writers wait."""
MAX_NAMES_LOGGED, NAME_LENGTH_LOGGED = 10, 12
"""Names of files in one line of the log, and characters of each name."""


@dataclass(frozen=True, slots=True)
class SweepReport:
    """The number of files of each kind that a sweep moved or removed.

    temporaries: removed files of dead processes; removed: finished removals; set_aside: moved to
    the quarantine; brought_back: moved back from it; purged: removed from it.
    """

    temporaries: int = 0
    removed: int = 0
    set_aside: int = 0
    brought_back: int = 0
    purged: int = 0


def sweep(store: Store, retention_days: float) -> SweepReport:
    """Sweeps the folder of files. It is safe while other processes use the library.

    retention_days: how long the quarantine keeps a file. Raises StorageError, also if the folder
    does not belong to the library: then nothing is changed.
    """
    store.files.check_identity()
    temporaries = store.files.remove_abandoned_temporaries()
    removed = store.finish_removals()
    # Listed before the database is read. Otherwise a file that is stored in between would seem
    # unneeded.
    stored = set(store.files)
    quarantined = set(store.files.quarantine)
    with store.read() as tx:
        needed = references.referenced(tx)
    brought_back = _bring_back(store, quarantined & needed)
    set_aside = _set_aside(store, stored - needed)
    purged = store.files.quarantine.purge(retention_days * DAY_S)
    if purged:
        _warn("files were removed after %g days in the quarantine", retention_days, names=purged)
    store.make_reserve()
    return SweepReport(temporaries, removed, len(set_aside), len(brought_back), len(purged))


def _bring_back(store: Store, names: Collection[str]) -> list[str]:
    moved = [sha256 for sha256 in sorted(names) if store.files.bring_back(sha256)]
    if moved:
        _warn("files came back from the quarantine: the database names them again", names=moved)
    return moved


def _set_aside(store: Store, names: Collection[str]) -> list[str]:
    moved: list[str] = []
    for batch in in_batches(sorted(names), BATCH):
        with store.write() as tx:  # so that nobody stores one of them for a clip meanwhile
            for sha256 in references.unreferenced(tx, batch):
                store.files.set_aside(sha256)
                moved.append(sha256)
    if moved:
        _warn(
            "files that the database does not name were moved to %s: a crash left them, or the "
            "database is not the newest one; they come back when it names them again",
            store.files.quarantine.name,
            names=moved,
        )
    return moved


def _warn(text: str, *arguments: object, names: Collection[str]) -> None:
    """Logs a warning about some files: their number, and the first of their names."""
    logged = [name[:NAME_LENGTH_LOGGED] for name in sorted(names)[:MAX_NAMES_LOGGED]]
    fields = {"count": len(names), "files": logged}
    _log.warning(text, *arguments, extra={"fields": fields})


def try_to_sweep(store: Store, retention_days: float) -> SweepReport:
    """As `sweep`, but a failure is only logged, because the next sweep tries again."""
    try:
        return sweep(store, retention_days)
    except StorageError as problem:
        _log.error("the files could not be swept: %s", problem.detail)
        return SweepReport()
