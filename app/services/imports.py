"""Imports: many files at once, from a ZIP, a folder or single files.

Each file becomes a clip with its own ingest job, in one transaction with the import's record
of it. An import that is cut off goes on where it stopped, and the same files imported twice
give the same clips.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from app.errors import (
    BadContent,
    Canceled,
    EmptyFile,
    KinedexError,
    LeaseLost,
    NotFound,
    StorageError,
    UnknownFormat,
)
from app.formats.sniff import HEAD_BYTES, is_zip
from app.services import fields
from app.services.clips import (
    BULK_PRIORITY,
    WORKER_DEATHS,
    add,
    check_content,
    keep,
)
from app.services.companions import pair_skeletons
from app.services.import_plan import Item, plan_import
from app.services.import_sources import (
    ArchiveLimits,
    SourceFile,
    archive_files,
    folder_files,
    is_archive,
    single_file,
)
from app.services.library import Library
from app.services.manifest import ManifestRow
from app.services.recordings import described
from app.store import imports as stored
from app.store import jobs, keypose_annotations, leases
from app.store.clip_record import ClipState
from app.store.clip_record import NewClip as NewRow
from app.store.engine import Tx
from app.store.files import Readable, StagedFile
from app.store.ids import new_id
from app.store.imports import ImportOutcome
from app.store.job_record import ClaimedJob, JobKind, JobRecord, Lease, NewJob

IMPORT_PRIORITY = 10
OWN_PRIORITY = -1_000_000_000
"""Of an import that this process does itself: no worker may take it first."""

Progress = Callable[[int, int, str], None]
"""Told after each file: files done, files in all, the file's path."""
_NOTHING = ManifestRow(line=0)


def start_import(lib: Library, archive: Readable, filename: str) -> JobRecord:
    """Store a ZIP durably and queue its import.

    Raises EmptyFile, UnknownFormat for what is no ZIP, TooLarge, DiskFull.
    """
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
                    payload={"filename": fields.file_name(filename)},
                    priority=IMPORT_PRIORITY,
                    max_attempts=WORKER_DEATHS,
                ),
            )


def unpack(
    lib: Library, claimed: ClaimedJob, progress: Progress, should_stop: Callable[[], bool]
) -> None:
    """Do a claimed import: register every file, then leave the job to its clips' ingests.

    `should_stop` is asked before each file; then Canceled is raised, and what was registered
    stays. Raises BadContent or TooLarge where the archive as a whole cannot be used,
    LeaseLost where the job was given to another worker.
    """
    if claimed.file_sha256 is None:
        raise BadContent("The command that imported these files was interrupted: run it again.")
    archive = lib.store.files.path(claimed.file_sha256)
    with archive_files(archive, _limits(lib)) as files:
        _register_all(_Doing(lib, claimed.lease), files, progress, should_stop)
    _leave_to_clips(lib, claimed.lease)


def import_path(lib: Library, path: Path, progress: Progress | None = None) -> JobRecord:
    """Import a folder, a ZIP or a single file from this machine's disk.

    Returns the import's job once every file is registered; it ends when a worker has analysed
    the clips. Raises NotFound where there is no such path, and as `unpack` does.
    """
    with _sources(lib, path) as files:
        claimed = _own_job(lib, path)
        told = progress or (lambda *_: None)
        _register_all(_Doing(lib, claimed.lease), files, told, lambda: False)
    return _leave_to_clips(lib, claimed.lease)


@contextmanager
def _sources(lib: Library, path: Path) -> Iterator[list[SourceFile]]:
    if path.is_dir():
        yield folder_files(path)
    elif is_archive(path):
        with archive_files(path, _limits(lib)) as files:
            yield files
    elif path.is_file():
        yield single_file(path, _skeleton_beside(path))
    else:
        raise NotFound(f"There is no file or folder {path}.")


def _skeleton_beside(path: Path) -> Path | None:
    """The ASF file in the folder of a single AMC file that is its skeleton."""
    if path.suffix.lower() != ".amc":
        return None
    names = [other.name for other in path.parent.iterdir() if other.suffix.lower() == ".asf"]
    name = pair_skeletons([path.name, *sorted(names)]).get(path.name)
    return None if name is None else path.parent / name


def _own_job(lib: Library, path: Path) -> ClaimedJob:
    """A job that this process has from the start; queued and claimed in one transaction."""
    job = NewJob(
        JobKind.IMPORT,
        payload={"filename": fields.file_name(str(path))},
        priority=OWN_PRIORITY,
        max_attempts=1,
    )
    with lib.store.write() as tx:
        created = jobs.enqueue(tx, job)
        claimed = leases.claim(tx, [JobKind.IMPORT], new_id("import"), lib.settings.job_lease_s)
        if claimed is None or claimed.job.id != created.id:
            raise StorageError("Another import begins at this moment; try again.")
        return claimed


@dataclass(frozen=True, slots=True)
class _Doing:
    """An import in hand: the library, the right to its job."""

    lib: Library
    lease: Lease

    def record(self, tx: Tx, path: str, outcome: ImportOutcome, **values: Any) -> None:
        """Record a file in the transaction that stores it, and renew the lease there.

        Raises LeaseLost where another worker has the import, Canceled where it is to end; the
        transaction is then undone.
        """
        if leases.heartbeat(tx, self.lease, self.lib.settings.job_lease_s):
            raise Canceled("The import was canceled.")
        stored.add_entry(tx, self.lease.job_id, path, outcome, **values)

    def record_problem(self, path: str, problem: KinedexError) -> None:
        """Record why a file became no clip."""
        with self.lib.store.write() as tx:
            self.record(tx, path, ImportOutcome.FAILED, problem=problem.as_problem())


def _register_all(
    doing: _Doing,
    files: Iterable[SourceFile],
    progress: Progress,
    should_stop: Callable[[], bool],
) -> None:
    plan = plan_import(files)
    with doing.lib.store.read() as tx:
        recorded = stored.recorded_paths(tx, doing.lease.job_id)
    total = len(plan.items) + len(plan.absent)
    for done, item in enumerate(plan.items, 1):
        if should_stop():
            raise Canceled("The import was stopped.")
        if item.file.path not in recorded:
            _register(doing, item)
        progress(done, total, item.file.path)
    for path, problem in plan.absent.items():
        if path not in recorded:
            doing.record_problem(path, problem)


def _register(doing: _Doing, item: Item) -> None:
    """Store one file as a clip, or record why not; failures of the store are raised."""
    try:
        if problem := item.file.problem or item.row.problem:
            raise problem
        with item.file.open() as content:
            _store_file(doing, content, item)
    except (StorageError, LeaseLost, Canceled):
        raise
    except KinedexError as problem:
        doing.record_problem(item.file.path, problem)


def _store_file(doing: _Doing, content: Readable, item: Item) -> None:
    lib, row, path = doing.lib, item.row, item.file.path
    with ExitStack() as files:
        staged = _stage(lib, files, content)
        is_amc = check_content(staged) == "amc"
        companion = _staged(lib, files, item.skeleton if is_amc else None)
        recording = _staged(lib, files, item.sound)
        heard = {} if recording is None else described(recording, row.audio or "")
        new = replace(_new_row(path, row, staged, companion), **heard)
        with lib.store.write() as tx:
            keep(staged, companion, recording)
            created = add(tx, new, BULK_PRIORITY)
            if created.is_new and row.keyposes is not None:
                keypose_annotations.put(tx, created.clip.id, row.keyposes)
            is_done = not created.is_new and created.clip.state is ClipState.READY
            outcome = ImportOutcome.EXISTS if is_done else ImportOutcome.QUEUED
            doing.record(tx, path, outcome, clip_id=created.clip.id)


def _staged(lib: Library, files: ExitStack, source: SourceFile | None) -> StagedFile | None:
    """A file that goes with a motion, if there is one, for as long as `files` are open."""
    if source is None:
        return None
    if source.problem is not None:
        raise source.problem
    return _stage(lib, files, files.enter_context(source.open()))


def _stage(lib: Library, files: ExitStack, content: Readable) -> StagedFile:
    limit = lib.settings.max_upload_bytes
    return files.enter_context(lib.store.files.stage(content, max_bytes=limit))


def _new_row(
    path: str, row: ManifestRow, staged: StagedFile, skeleton: StagedFile | None
) -> NewRow:
    file_name = fields.file_name(path)
    return NewRow(
        sha256=staged.sha256,
        file_name=file_name,
        file_size=staged.size,
        name=row.name or fields.stem(file_name),
        person=row.person,
        task=row.task,
        words=row.words or (),
        license=row.license,
        source=row.source,
        skeleton_sha256=None if skeleton is None else skeleton.sha256,
        frame_rate_override=row.frame_rate,
        metres_per_unit_override=row.metres_per_unit,
        audio_offset_override=row.audio_offset,
        tempo_override=row.tempo,
        beats_override=row.beats,
    )


def _leave_to_clips(lib: Library, lease: Lease) -> JobRecord:
    with lib.store.write() as tx:
        return stored.wait_for_clips(tx, lease, "waiting for the clips' analyses")


def _limits(lib: Library) -> ArchiveLimits:
    settings = lib.settings
    return ArchiveLimits(
        settings.max_archive_entries, settings.max_archive_ratio, settings.max_upload_bytes
    )
