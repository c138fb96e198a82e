"""Mends a library after damage: what `kinedex doctor --mend` does.

| damage | mended by |
|---|---|
| an index of the database does not fit its table | the index is built again |
| a file is missing or has other bytes | a copy with the right SHA-256 in a backup |
| an array of a clip cannot be read, or is missing | another analysis of the clip's file |
| an array of a model cannot be read | another fit |
| a clip failed because its file was missing, and the file is back | another analysis |

What stays is marked: a ready clip without its file gets a warning and stays searchable. A clip
without its file and without its arrays becomes failed, because nothing of it can be shown. Tables
with damaged pages are not mended, because rows may be lost: the whole backup replaces them.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path

from app.errors import FileDamaged, StoredFileMissing
from app.services.clips.catalogue import BULK_PRIORITY, enqueue_ingest
from app.services.library.stored_motion import JOINT_NAMES, PARENTS, POSITIONS
from app.services.training.models import enqueue_fit
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord, ClipState, Reanalysis
from app.store.database.engine import Tx
from app.store.store import Store
from app.store.upkeep import mend as parts
from app.store.upkeep.verify import Progress, VerificationReport, verify

NEEDED_ARRAYS = (POSITIONS, PARENTS, JOINT_NAMES)
"""The arrays without which a ready clip cannot be shown."""
MODEL_PREFIX = "model_"
"""Begins the ids of models, in the names of arrays too."""


@dataclass(slots=True)
class MendReport:
    """What was mended, and what could not be.

    has_rebuilt_indexes; restored: names of files; queued: ids of clips that wait for another
    analysis; cleared: ids of clips whose warning was removed; is_fit_queued; marked: ids of ready
    clips with a warning that a file is missing or damaged; failed: ids of clips that were made
    failed; left: names of files that are still missing or damaged.
    """

    has_rebuilt_indexes: bool = False
    restored: list[str] = field(default_factory=list)
    queued: list[str] = field(default_factory=list)
    cleared: list[str] = field(default_factory=list)
    is_fit_queued: bool = False
    marked: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)


def examine(store: Store, progress: Progress | None = None) -> VerificationReport:
    """Compare every row with every file and array. Raises StorageError."""
    return verify(store, progress, needed_arrays=NEEDED_ARRAYS)


def mend(store: Store, found: VerificationReport, backup: Path | None = None) -> MendReport:
    """Mend what `examine` has found, while others may use the library; delete nothing.

    backup: a folder that `kinedex backup` made, or another data directory. Raises BadField if it is
    none; DiskFull; StorageError.
    """
    files = None if backup is None else parts.open_backup(backup)
    report = MendReport()
    if found.damage:
        report.has_rebuilt_indexes = parts.rebuild_indexes(store)
        if not report.has_rebuilt_indexes:
            return report  # rows that cannot be trusted must not lead to changes
        found = examine(store)
    missing, damaged = set(found.missing), set(found.damaged)
    if files is not None:
        report.restored += parts.restore_files(store, sorted(missing | damaged), files)
        missing.difference_update(report.restored)
        damaged.difference_update(report.restored)
    report.left = sorted(missing | damaged)
    with store.write() as tx:
        _mend_arrays(tx, (*found.unreadable, *found.lacking), missing, damaged, report)
        _clear(tx, missing | damaged, report)
        for clip in parts.clips_of_files(tx, report.left):
            if parts.mark(tx, clip, missing, damaged):
                report.marked.append(clip.id)
    return report


def _mend_arrays(
    tx: Tx,
    names: Collection[str],
    missing: Collection[str],
    damaged: Collection[str],
    report: MendReport,
) -> None:
    owners = {name.partition("/")[0] for name in names}
    if any(owner.startswith(MODEL_PREFIX) for owner in owners):
        enqueue_fit(tx)
        report.is_fit_queued = True
    for clip in clips.get_many(tx, sorted(owners)).values():
        files = parts.files_of(clip)
        lost = [sha256 for sha256 in files if sha256 in missing or sha256 in damaged]
        if not lost:
            _analyze_again(tx, clip, report)
        elif clip.state is ClipState.READY:
            kind = StoredFileMissing if lost[0] in missing else FileDamaged
            problem = kind(
                f"The stored {files[lost[0]]} of this clip is "
                f"{'missing' if lost[0] in missing else 'damaged'} ({lost[0]}), and so are arrays "
                "of its analysis. Send the same file again, or run "
                "`kinedex doctor --mend --from BACKUP`."
            )
            clips.set_failed(tx, clip.id, problem.as_problem())
            report.failed.append(clip.id)


def _clear(tx: Tx, bad: set[str], report: MendReport) -> None:
    """Clips that lacked a file and have all files now: a new analysis, or just no warning."""
    for clip in parts.clips_that_lacked_files(tx):
        if bad & parts.files_of(clip).keys() or clip.id in report.queued:
            continue
        if clip.state is ClipState.FAILED or clip.reanalysis is Reanalysis.FAILED:
            _analyze_again(tx, clip, report)
        elif clip.state is ClipState.READY:
            parts.unmark(tx, clip)
            report.cleared.append(clip.id)


def _analyze_again(tx: Tx, clip: ClipRecord, report: MendReport) -> None:
    enqueue_ingest(tx, clip.id, BULK_PRIORITY)
    clips.requeue(tx, clip.id)
    report.queued.append(clip.id)
