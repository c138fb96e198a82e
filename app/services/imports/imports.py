"""Imports: many files at once, from a ZIP, a folder or single files.

Each file becomes a clip with its own ingest job, in one transaction with the import's record of it.
An import that was interrupted continues where it stopped. The same files imported twice give the
same clips. A worker does one import at a time, so a long one gives way to others now and then: its
job returns to the queue with its progress.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from app.errors import BadContent, EmptyFile, NotFound, StorageError, UnknownFormat
from app.formats.sniff import HEAD_BYTES, is_zip
from app.services import fields
from app.services.clips.catalogue import WORKER_DEATHS
from app.services.imports.manifest_table import ManifestLimits
from app.services.imports.options import ImportOptions
from app.services.imports.plan import Plan
from app.services.imports.register import ImportRun, Progress
from app.services.imports.skeleton_pairs import skeleton_beside
from app.services.imports.sources import (
    ArchiveLimits,
    SourceFile,
    archive_files,
    folder_files,
    is_archive,
    single_file,
)
from app.services.library.library import Library
from app.store.files.files import Readable
from app.store.jobs import imports as stored
from app.store.jobs import leases, owners
from app.store.jobs import repository as jobs
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, NewJob

IMPORT_PRIORITY = 10
LOWEST_PRIORITY = 20
"""With each turn an import's priority goes down one step: new imports run first."""
TURN_S = 5.0
"""How long an import runs before it asks whether others wait. A turn is at least as long as reading
the archive's directory took, because each turn reads it again."""
OWN_PRIORITY = -1_000_000_000
"""The priority of an import that this process does itself: no worker may take it first."""
OPTIONS = "options"
"""Member of the payload of an import."""
DEMO = "demo"
"""Member of the payload of an import that makes its own files: the demo library. Only one such
import is queued at a time."""
WAITING = "waiting for the clips' analyses"


def start_import(
    lib: Library, archive: Readable, filename: str, options: ImportOptions | None = None
) -> JobRecord:
    """Store a ZIP durably and queue its import.

    Raises EmptyFile, UnknownFormat for what is no ZIP, TooLarge, DiskFull, and BadField for bad
    options.
    """
    chosen = options or ImportOptions()
    chosen.check()
    with lib.store.files.stage(archive, max_bytes=lib.settings.max_archive_bytes) as staged:
        with staged.open() as file:
            head = file.read(HEAD_BYTES)
            if not head:
                raise EmptyFile()
            if not is_zip(head):
                raise UnknownFormat("An import takes a ZIP archive.")
        with lib.store.write() as tx:
            staged.keep()
            return jobs.enqueue(
                tx,
                NewJob(
                    JobKind.IMPORT,
                    file_sha256=staged.sha256,
                    payload={
                        "filename": fields.file_name(filename),
                        OPTIONS: chosen.as_payload(),
                    },
                    priority=IMPORT_PRIORITY,
                    max_attempts=WORKER_DEATHS,
                ),
            )


def start_demo(lib: Library) -> JobRecord:
    """Queue an import of the demo library, whose files the worker generates.

    Returns the queued job if there is one already. Clips that exist are not added again.
    """
    job = NewJob(
        JobKind.IMPORT,
        payload={"filename": "demo library", DEMO: True, OPTIONS: ImportOptions().as_payload()},
        priority=IMPORT_PRIORITY,
        max_attempts=WORKER_DEATHS,
        dedupe_key=DEMO,
    )
    with lib.store.write() as tx:
        return jobs.enqueue(tx, job)


def unpack(
    lib: Library, claimed: ClaimedJob, progress: Progress, should_stop: Callable[[], bool]
) -> None:
    """Do a claimed import: register its files, then leave the job to its clips' ingests.

    If other imports wait, it stops after its turn: the job returns to the queue and continues
    later. If `should_stop` returns True before a file, it raises Canceled; the clips that exist
    already stay. Raises BadContent or TooLarge if the archive as a whole cannot be used, and
    LeaseLost if another worker has the job now.
    """
    began = time.monotonic()
    with _files_of(lib, claimed) as files:
        options = ImportOptions.of_payload(claimed.payload.get(OPTIONS))
        run = ImportRun(lib, claimed.lease, _plan(lib, files, options))
        turn = _Turn(lib, max(TURN_S, time.monotonic() - began))
        if run.run(progress, should_stop, turn.is_over):
            run.finish(WAITING)
        else:
            _give_turn(run)


@contextmanager
def _files_of(lib: Library, claimed: ClaimedJob) -> Iterator[list[SourceFile]]:
    """The files of a claimed import: those of its archive, or those of the demo library."""
    if claimed.payload.get(DEMO):
        # Imported here: only this import needs it, and it is slow to import.
        from app.demo.library import write_demo

        with tempfile.TemporaryDirectory() as folder:
            write_demo(Path(folder))
            yield folder_files(Path(folder))
        return
    if claimed.file_sha256 is None:
        raise BadContent("The command that imported these files was interrupted: run it again.")
    with archive_files(lib.store.files.path(claimed.file_sha256), _limits(lib)) as files:
        yield files


def import_path(
    lib: Library,
    path: Path,
    progress: Progress | None = None,
    options: ImportOptions | None = None,
) -> JobRecord:
    """Import a folder, a ZIP or a single file from this machine's disk.

    Returns the job of the import after every file was registered. The job ends when a worker has
    analyzed the clips. Raises NotFound if the path does not exist, BadField for bad options, and
    the errors of `unpack`.
    """
    chosen = options or ImportOptions()
    chosen.check()
    with _sources(lib, path) as files:
        plan = _plan(lib, files, chosen)
        run = ImportRun(lib, _own_job(lib, path).lease, plan)
        run.run(progress or (lambda *_: None), lambda: False, lambda: False)
        return run.finish(WAITING)


class _Turn:
    """The time for which an import may run while others wait."""

    def __init__(self, lib: Library, seconds: float) -> None:
        self._lib, self._seconds = lib, seconds
        self._began = time.monotonic()

    def is_over(self) -> bool:
        """Whether another import must run now; if none waits, another turn begins."""
        if time.monotonic() - self._began < self._seconds:
            return False
        self._began = time.monotonic()
        with self._lib.store.read() as tx:
            return leases.is_any_claimable(tx, [JobKind.IMPORT])


def _give_turn(run: ImportRun) -> None:
    detail = f"{run.done} of {run.total} files; waiting for other imports"
    with run.lib.store.write() as tx:
        stored.requeue_behind_others(tx, run.lease, run.done / run.total, detail, LOWEST_PRIORITY)


@contextmanager
def _sources(lib: Library, path: Path) -> Iterator[list[SourceFile]]:
    if path.is_dir():
        yield folder_files(path, lib.settings.data_dir)
    elif is_archive(path):
        with archive_files(path, _limits(lib)) as files:
            yield files
    elif path.is_file():
        yield single_file(path, skeleton_beside(path))
    else:
        raise NotFound(f"There is no file or folder {path}.")


def _own_job(lib: Library, path: Path) -> ClaimedJob:
    """A job of this process: queued and claimed in one transaction, so that no worker takes it."""
    job = NewJob(
        JobKind.IMPORT,
        payload={"filename": fields.file_name(str(path))},
        priority=OWN_PRIORITY,
        max_attempts=1,
    )
    with lib.store.write() as tx:
        created = jobs.enqueue(tx, job)
        claimed = leases.claim(tx, [JobKind.IMPORT], owners.new_owner("import"))
        if claimed is None or claimed.job.id != created.id:
            raise StorageError("Another import started at the same moment; try again.")
        return claimed


def _plan(lib: Library, files: Sequence[SourceFile], options: ImportOptions) -> Plan:
    # A local folder may have more files than an archive may, and one manifest row for each file.
    rows = max(lib.settings.max_archive_entries, len(files))
    return Plan(files, ManifestLimits(rows), options)


def _limits(lib: Library) -> ArchiveLimits:
    settings = lib.settings
    return ArchiveLimits(
        settings.max_archive_entries, settings.max_archive_ratio, settings.max_upload_bytes
    )
