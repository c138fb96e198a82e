"""What tidies the folder of files: finishes removals, and sets aside what nobody names.

A sweep deletes only what was recorded to be deleted, what dead uploads left, and what was in the
quarantine for the whole retention. Restoring database and files in any order is therefore safe.
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
"""Files moved in one transaction, so that others need not wait long."""
NAMES_SHOWN, NAME_SHOWN = 10, 12
"""Names in the log, and letters of each."""


@dataclass(frozen=True, slots=True)
class SweepReport:
    """How many files of each kind a sweep dealt with."""

    temporaries: int = 0
    removed: int = 0
    set_aside: int = 0
    brought_back: int = 0
    purged: int = 0


def sweep(store: Store, retention_days: float) -> SweepReport:
    """Tidies the folder of files, while others use it; safe to call at any time.

    Raises StorageError, where the folder is not that of the database too: then nothing is done.
    """
    store.files.check_identity()
    temporaries = store.files.remove_abandoned_temporaries()
    removed = store.finish_removals()
    here = set(store.files)  # before the database is asked, which then knows all of them
    aside = set(store.files.quarantine)
    with store.read() as tx:
        needed = references.referenced(tx)
    brought_back = _bring_back(store, aside & needed)
    set_aside = _set_aside(store, here - needed)
    purged = store.files.quarantine.purge(retention_days * DAY_S)
    if purged:
        _tell("files were removed after %g days in the quarantine", retention_days, purged)
    store.make_reserve()
    return SweepReport(temporaries, removed, len(set_aside), len(brought_back), len(purged))


def _bring_back(store: Store, names: Collection[str]) -> list[str]:
    found = [sha256 for sha256 in sorted(names) if store.files.bring_back(sha256)]
    if found:
        _tell("files came back from the quarantine: the database names them again", found)
    return found


def _set_aside(store: Store, names: Collection[str]) -> list[str]:
    moved: list[str] = []
    for batch in in_batches(sorted(names), BATCH):
        with store.write() as tx:  # so that none of them is stored for a clip meanwhile
            for sha256 in references.unreferenced(tx, batch):
                store.files.set_aside(sha256)
                moved.append(sha256)
    if moved:
        _tell(
            "files that the database does not name were moved to %s: a crash left them, or the "
            "database is not the newest one; they come back when it names them again",
            store.files.quarantine.folder,
            moved,
        )
    return moved


def _tell(text: str, *told: object) -> None:
    """Logs a warning; the last of `told` are names."""
    *values, names = told
    shown = sorted(names)[:NAMES_SHOWN]  # type: ignore[call-overload]
    fields = {"count": len(names), "files": [name[:NAME_SHOWN] for name in shown]}  # type: ignore[arg-type]
    _log.warning(text, *values, extra={"fields": fields})


def try_to_sweep(store: Store, retention_days: float) -> SweepReport:
    """As `sweep`; a failure goes to the log, since the next sweep tries again."""
    try:
        return sweep(store, retention_days)
    except StorageError as problem:
        _log.error("the files could not be swept: %s", problem.detail)
        return SweepReport()
