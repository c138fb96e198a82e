"""Registers the files of an import: each file becomes a clip with an ingest job, or a problem.

A clip, its job and the import's record of it are stored in one transaction. Files that become no
clip are recorded together, because each transaction waits for the disk.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack

from app.errors import Canceled, LeaseLost, StorageError
from app.formats.sniff import HEAD_BYTES, TAIL_BYTES, sniff
from app.kinedex_error import KinedexError
from app.services import fields
from app.services.annotations.checks import of_spans
from app.services.clips.catalogue import BULK_PRIORITY, Created, add, check_content, keep
from app.services.clips.merging import OnConflict
from app.services.clips.recordings import attached
from app.services.imports.annotations import put_annotations, read_beside
from app.services.imports.keyposes import put_keyposes
from app.services.imports.plan import Item, Plan
from app.services.imports.skipped import is_skipped, refuse_companion
from app.services.imports.sources import SourceFile
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.clip_annotations import NewAnnotation
from app.store.clips.record import ClipState, Difference, NewClip
from app.store.database.engine import Tx
from app.store.files.files import Readable, StagedFile
from app.store.jobs import imports as stored
from app.store.jobs import leases
from app.store.jobs.import_files import ImportOutcome
from app.store.jobs.imports import NewEntry
from app.store.jobs.record import JobRecord, Lease

Progress = Callable[[int, int, str], None]
"""Called after each file with the number of files done, the number of all files, and the path."""
TurnCheck = Callable[[], bool]
"""Returns whether the import must stop now, so that other imports can run."""

MAX_PROBLEMS_TOGETHER = 500
"""Files without a clip that are recorded in one transaction."""
RECORD_AFTER_S = 1.0
"""Problems wait at most this long (seconds), since a cancellation is noticed only then."""
FIRST_CLIPS = 64
MAX_PRIORITY_STEPS = 9
"""The clips of a large import wait for the clips of a small import: after the first 64 clips the
priority is one step lower, after 128 two steps, after 256 three, up to MAX_PRIORITY_STEPS."""
MAX_CHECKED_BYTES = HEAD_BYTES + TAIL_BYTES
"""A file of at most this size is checked before it is written to disk."""


class ImportRun:
    """A running import: its plan, and the lease of its job."""

    def __init__(self, lib: Library, lease: Lease, plan: Plan) -> None:
        self.lib, self.lease, self.plan = lib, lease, plan
        self.done = 0
        self._problems: list[NewEntry] = []
        self._recorded_at = time.monotonic()
        with lib.store.read() as tx:
            self._recorded = stored.recorded_paths(tx, lease.job_id)

    @property
    def total(self) -> int:
        """The number of files that may become clips."""
        return len(self.plan.motions)

    def run(
        self, progress: Progress, should_stop: Callable[[], bool], is_turn_over: TurnCheck
    ) -> bool:
        """Register the files one by one; returns whether all files are registered.

        If `should_stop` returns True before a file, it raises Canceled. If `is_turn_over` returns
        True after a file, it returns False. Also raises LeaseLost and StorageError.
        """
        for number, file in enumerate(self.plan.motions, 1):
            self.done = number
            if should_stop():
                raise Canceled("The import was stopped.")
            if file.path in self._recorded:
                continue  # registered before the import was interrupted
            self._register(self.plan.item(file))
            progress(self.done, self.total, file.path)
            if number < self.total and is_turn_over():
                self.record_problems()
                return False
        self.record_problems()
        return True

    def finish(self, detail: str) -> JobRecord:
        """Record the missing files that manifests name. After that the job waits for its clips."""
        with self.lib.store.write() as tx:
            absent = [
                NewEntry(path, ImportOutcome.ABSENT, problem=problem.as_problem())
                for path, problem in self.plan.absent.items()
                if path not in self._recorded
            ]
            stored.add_entries(tx, self.lease.job_id, absent)
            return stored.wait_for_clips(
                tx,
                self.lease,
                detail,
                absent=self.plan.absent_count,
                unmatched=self.plan.unmatched,
            )

    def record_problems(self) -> None:
        """Record the problems that were not recorded yet. Raises LeaseLost, Canceled."""
        if self._problems:
            with self.lib.store.write() as tx:
                self._record(tx)
            self._problems = []

    def _record(self, tx: Tx, *more: NewEntry) -> None:
        """Record problems and `more` in the caller's transaction, with a heartbeat of the job.

        Raises LeaseLost if another worker has the import, and Canceled if somebody canceled it;
        both undo the transaction.
        """
        if leases.heartbeat(tx, self.lease, has_progressed=True):
            raise Canceled("The import was canceled.")
        stored.add_entries(tx, self.lease.job_id, [*self._problems, *more])
        self._recorded_at = time.monotonic()

    def _register(self, item: Item) -> None:
        """Store one file as a clip, or keep its problem. Raises the failures of the store."""
        try:
            if problem := item.file.problem or item.row.problem:
                raise problem
            with item.file.open() as content:
                self._store(checked_content(content), item)
        except (StorageError, LeaseLost, Canceled):
            raise  # these concern the whole import, not this file
        except KinedexError as problem:
            self._add_problem(item.file.path, problem)

    def _add_problem(self, path: str, problem: KinedexError) -> None:
        outcome = ImportOutcome.SKIPPED if is_skipped(path, problem) else ImportOutcome.FAILED
        self._problems.append(NewEntry(path, outcome, problem=problem.as_problem()))
        waited = time.monotonic() - self._recorded_at
        if len(self._problems) >= MAX_PROBLEMS_TOGETHER or waited >= RECORD_AFTER_S:
            self.record_problems()

    def _store(self, content: Readable, item: Item) -> None:
        lib, row, path = self.lib, item.row, item.file.path
        with ExitStack() as files:
            staged = _stage(lib, files, content)
            format = check_content(staged)
            refuse_companion(path, format)
            companion = _staged(lib, files, item.skeleton if format == "amc" else None)
            recording = _staged(lib, files, item.sound)
            new = NewClip(
                sha256=staged.sha256,
                file_name=fields.file_name(path),
                file_size=staged.size,
                labels=row.values.labels,
                hints=row.values.hints,
                skeleton_sha256=None if companion is None else companion.sha256,
                audio=None if recording is None else attached(recording, row.audio or ""),
                path=fields.path(path),
                sent=row.values.sent,
            )
            said = self._annotations_of(item)
            with lib.store.write() as tx:
                keep(staged, companion, recording)
                self._record(tx, self._added(tx, new, row.keyposes, said, path))
        self._problems = []

    def _annotations_of(self, item: Item) -> tuple[NewAnnotation, ...] | None:
        """The annotations of a motion in the import; None if it has none.

        A bad file of annotations is a problem of its own: the motion is stored without it.
        """
        if item.beside is not None:
            try:
                return read_beside(item.beside)
            except KinedexError as problem:
                self._add_problem(item.beside.path, problem)
        return of_spans(item.spans, None) if item.spans else None

    def _added(
        self,
        tx: Tx,
        new: NewClip,
        keyposes: tuple[float, ...] | None,
        said: tuple[NewAnnotation, ...] | None,
        path: str,
    ) -> NewEntry:
        """Add the clip of a file, or merge its labels with those of the clip that exists."""
        is_twin = self._is_recorded(tx, new)
        # If two files of an import have the same content, the labels of the first one count: else
        # each import would change them twice.
        policy = OnConflict.KEEP if is_twin else self.plan.options.on_conflict
        created = add(tx, new, self._priority(), policy, self.plan.paths)
        clip, differences = created.clip, created.differences
        if keyposes is not None:
            found = put_keyposes(tx, clip, keyposes, policy)
            differences += () if created.is_new else found
        if said is not None:
            found = put_annotations(tx, clip, said, policy)
            differences += () if created.is_new else found
        outcome = _outcome(created, differences, is_twin)
        return NewEntry(path, outcome, clip_id=clip.id, differences=differences)

    def _is_recorded(self, tx: Tx, new: NewClip) -> bool:
        """Whether an earlier file of this import has the same content."""
        existing = clips.find_by_content(tx, new.content_key)
        return existing is not None and stored.has_clip(tx, self.lease.job_id, existing.id)

    def _priority(self) -> int:
        """The priority of the next analysis. A large import must not delay a small one."""
        return BULK_PRIORITY + min((self.done // FIRST_CLIPS).bit_length(), MAX_PRIORITY_STEPS)


def _outcome(created: Created, differences: tuple[Difference, ...], is_twin: bool) -> ImportOutcome:
    """The outcome of a stored file; is_twin: an earlier file of the import has its content."""
    if not all(one.applied for one in differences):
        return ImportOutcome.CONFLICTING
    if differences:
        return ImportOutcome.UPDATED
    is_ready = not created.is_new and created.clip.state is ClipState.READY
    return ImportOutcome.UNCHANGED if is_ready or is_twin else ImportOutcome.QUEUED


def checked_content(content: Readable) -> Readable:
    """The same content, after a check of its format if the file is small.

    So a small file that is no motion is never written to disk. Raises EmptyFile, UnknownFormat.
    """
    chunks, size = [], 0
    while size <= MAX_CHECKED_BYTES and (chunk := content.read(MAX_CHECKED_BYTES + 1 - size)):
        chunks.append(chunk)
        size += len(chunk)
    head = b"".join(chunks)
    if size <= MAX_CHECKED_BYTES:
        sniff(head)
    return _Rejoined(head, content)


class _Rejoined:
    """A file whose first bytes were read already: `read` returns them first, then the rest."""

    def __init__(self, head: bytes, rest: Readable) -> None:
        self._head, self._rest = memoryview(head), rest

    def read(self, size: int, /) -> bytes:
        """The next bytes, at most `size`; empty at the end."""
        if not self._head:
            return self._rest.read(size)
        part, self._head = self._head[:size], self._head[size:]
        return bytes(part)


def _staged(lib: Library, files: ExitStack, source: SourceFile | None) -> StagedFile | None:
    """Stage the skeleton or the recording of a motion, if there is one, until `files` closes."""
    if source is None:
        return None
    if source.problem is not None:
        raise source.problem
    return _stage(lib, files, files.enter_context(source.open()))


def _stage(lib: Library, files: ExitStack, content: Readable) -> StagedFile:
    limit = lib.settings.max_upload_bytes
    return files.enter_context(lib.store.files.stage(content, max_bytes=limit))
