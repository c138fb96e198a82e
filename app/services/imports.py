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
    Place,
    StorageError,
    UnknownFormat,
    Unreadable,
)
from app.formats.sniff import HEAD_BYTES, is_zip
from app.services import fields
from app.services.clips import BULK_PRIORITY, WORKER_DEATHS, add, check_content
from app.services.companions import pair_skeletons
from app.services.import_sources import (
    ArchiveLimits,
    SourceFile,
    archive_files,
    folder_files,
    is_archive,
    single_file,
)
from app.services.library import Library
from app.services.manifest import MANIFEST_NAME, ManifestRow, read_manifest
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
    listed = _each_once(files)
    manifest = _manifest_rows(listed)
    skeletons = _skeletons(listed)
    taken = {skeleton.path for skeleton in skeletons.values()}
    clips = [file for file in listed if not _is_manifest(file) and file.path not in taken]
    absent = sorted(manifest.keys() - {file.path for file in listed})
    with doing.lib.store.read() as tx:
        recorded = stored.recorded_paths(tx, doing.lease.job_id)
    total = len(clips) + len(absent)
    for done, file in enumerate(clips, 1):
        if should_stop():
            raise Canceled("The import was stopped.")
        if file.path not in recorded:
            row = manifest.get(file.path, _NOTHING)
            _register(doing, file, row, skeletons.get(file.path))
        progress(done, total, file.path)
    for path in absent:
        if path not in recorded:
            doing.record_problem(path, _absent(path, manifest[path]))


def _register(
    doing: _Doing, file: SourceFile, row: ManifestRow, skeleton: SourceFile | None
) -> None:
    """Store one file as a clip, or record why not; failures of the store are raised."""
    try:
        if problem := file.problem or row.problem:
            raise problem
        with file.open() as content:
            _store_file(doing, file.path, content, row, skeleton)
    except (StorageError, LeaseLost, Canceled):
        raise
    except KinedexError as problem:
        doing.record_problem(file.path, problem)


def _store_file(
    doing: _Doing, path: str, content: Readable, row: ManifestRow, skeleton: SourceFile | None
) -> None:
    lib = doing.lib
    with ExitStack() as files:
        limit = lib.settings.max_upload_bytes
        staged = files.enter_context(lib.store.files.stage(content, max_bytes=limit))
        companion = None
        if check_content(staged) == "amc" and skeleton is not None:
            if skeleton.problem is not None:
                raise skeleton.problem
            opened = files.enter_context(skeleton.open())
            companion = files.enter_context(lib.store.files.stage(opened, max_bytes=limit))
        with lib.store.write() as tx:
            staged.keep()
            if companion is not None:
                companion.keep()
            created = add(tx, _new_row(path, row, staged, companion), BULK_PRIORITY)
            if created.is_new and row.keyposes is not None:
                keypose_annotations.put(tx, created.clip.id, row.keyposes)
            is_done = not created.is_new and created.clip.state is ClipState.READY
            outcome = ImportOutcome.EXISTS if is_done else ImportOutcome.QUEUED
            doing.record(tx, path, outcome, clip_id=created.clip.id)


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
    )


def _leave_to_clips(lib: Library, lease: Lease) -> JobRecord:
    with lib.store.write() as tx:
        return stored.wait_for_clips(tx, lease, "waiting for the clips' analyses")


def _manifest_rows(files: Iterable[SourceFile]) -> dict[str, ManifestRow]:
    """What every manifest among the files says, by path; a bad one fails the whole import."""
    rows: dict[str, ManifestRow] = {}
    for file in files:
        if _is_manifest(file):
            rows |= read_manifest(_content(file), file.path.rpartition("/")[0])
    return rows


def _content(manifest: SourceFile) -> bytes:
    # One that is encrypted or damaged must not be passed over: its labels would be lost.
    if manifest.problem is not None:
        raise manifest.problem
    try:
        with manifest.open() as content:
            return content.read()
    except Unreadable as problem:
        raise Unreadable(f"{manifest.path}: {problem.detail}") from problem


def _skeletons(files: Iterable[SourceFile]) -> dict[str, SourceFile]:
    """The file of the skeleton that each AMC file moves, by the AMC's path."""
    by_path = {file.path: file for file in files}
    return {motion: by_path[path] for motion, path in pair_skeletons(by_path).items()}


def _is_manifest(file: SourceFile) -> bool:
    return file.path.rpartition("/")[2] == MANIFEST_NAME


def _each_once(files: Iterable[SourceFile]) -> list[SourceFile]:
    """The files with paths that are storable, and different where an archive repeats one."""
    seen: dict[str, int] = {}
    listed = []
    for file in files:
        path = file.path.encode("utf-8", "replace").decode()
        seen[path] = seen.get(path, 0) + 1
        name = path if seen[path] == 1 else f"{path} ({seen[path]})"
        listed.append(replace(file, path=name))
    return listed


def _absent(path: str, row: ManifestRow) -> KinedexError:
    place = Place(f"{MANIFEST_NAME} line {row.line}", f"{path} is not there")
    return BadContent("The manifest names a file that is not there.", places=[place])


def _limits(lib: Library) -> ArchiveLimits:
    settings = lib.settings
    return ArchiveLimits(
        settings.max_archive_entries, settings.max_archive_ratio, settings.max_upload_bytes
    )
