"""Compares the rows of a library with its files and arrays, and mends what is damaged."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

from app.cli.checks.finding import Care, Finding, fine, note, problem
from app.cli.output import progress_bar

if TYPE_CHECKING:
    from app.services.mending import MendReport
    from app.store.store import Store
    from app.store.upkeep.verify import VerificationReport

REPAIR = (
    "Stop all processes of Kinedex, and restore a backup (see Back up in the README); "
    "`kinedex verify` lists all damage."
)
MEND_FILES = (
    "Run `kinedex doctor --mend --from BACKUP`, or upload the same files again; `kinedex verify` "
    "names them."
)
MEND = "Run `kinedex doctor --mend`, and then a worker: `kinedex serve` runs one."
MAX_NAMES = 3
"""Names that a finding shows; `kinedex verify` prints all."""


def check_names(store: Store) -> Iterator[Finding]:
    """A quick check: pages of the database, and whether all files exist. Raises StorageError."""
    from app.store.jobs import references

    damage = store.database.find_damage(quick=True)
    if damage:
        yield problem("database", f"it is damaged: {damage[0]}", REPAIR)
    else:
        yield _whole(store, "a quick check found no damage")
    with store.read() as tx:
        needed = references.referenced(tx)
    missing = [sha256 for sha256 in needed if not store.files.has(sha256)]
    yield _files(len(needed), missing, ())


def check_contents(store: Store, care: Care) -> Iterator[Finding]:
    """Read everything, and mend it if `care` says so. Raises StorageError, BadField."""
    from app.services.mending import examine, mend

    with progress_bar() as bar:
        task = bar.add_task("reading", total=None)
        report = examine(store, lambda done, total: bar.update(task, completed=done, total=total))
        bar.update(task, completed=1, total=1)
    if not care.mends:
        yield from _found(store, report)
        return
    mended = mend(store, report, care.backup)
    yield from _mended(mended)
    yield from _found(store, examine(store), has_queued=bool(mended.queued))


def _whole(store: Store, seen: str) -> Finding:
    """No damage; seen: what was looked at, in the file of an SQLite database."""
    server = "its server keeps watch over its pages; `pg_amcheck` reads them all"
    return fine("integrity", seen if store.database.is_sqlite else server)


def _found(
    store: Store, report: VerificationReport, *, has_queued: bool = False
) -> Iterator[Finding]:
    if report.damage:
        advice = f"`kinedex doctor --mend` mends indexes only. {REPAIR}"
        yield problem("database", f"it is damaged: {report.damage[0]}", advice)
    else:
        yield _whole(store, "all pages and references of the database were read")
    yield _files(report.files, report.missing, report.damaged)
    arrays = (*report.unreadable, *report.lacking)
    if not arrays:
        yield fine("arrays", f"all {report.arrays} arrays can be read")
    elif has_queued:
        yield note("arrays", f"{len(arrays)} wait for an analysis: {_some(arrays)}")
    else:
        found = f"{len(arrays)} of {report.arrays} cannot be read or are missing: {_some(arrays)}"
        yield problem("arrays", found, MEND)


def _files(total: int, missing: Collection[str], damaged: Collection[str]) -> Finding:
    parts = [
        f"{len(names)} of {total} stored files are {kind}: {_some(names)}"
        for kind, names in (("missing", missing), ("damaged", damaged))
        if names
    ]
    if parts:
        return problem("files", "; ".join(parts), MEND_FILES)
    return fine("files", f"all {total} stored files are there")


def _some(names: Collection[str]) -> str:
    shown = ", ".join(sorted(names)[:MAX_NAMES])
    return shown if len(names) <= MAX_NAMES else f"{shown} ..."


def _mended(report: MendReport) -> Iterator[Finding]:
    """What was mended, and which clips were marked."""
    done = [
        (report.has_rebuilt_indexes, "the indexes of the database were built again"),
        (report.restored, f"files that came back from the backup: {len(report.restored)}"),
        (report.queued, f"clips that a worker analyzes again: {_some(report.queued)}"),
        (report.cleared, f"clips whose warning was removed: {len(report.cleared)}"),
        (report.is_fit_queued, "a worker fits the models again"),
    ]
    for is_done, text in done:
        if is_done:
            yield fine("mended", text)
    if report.marked:
        yield note("marked", f"clips with a warning that a file is bad: {_some(report.marked)}")
    if report.failed:
        found = f"clips that failed, without a file and without arrays: {_some(report.failed)}"
        yield note("marked", found, MEND_FILES)
