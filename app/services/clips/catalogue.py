"""Clips: add, list, get, change and delete them."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from app.errors import BadContent, EmptyFile, NotFound
from app.formats.read import check_stack_belongs
from app.formats.sniff import HEAD_BYTES, TAIL_BYTES, sniff
from app.services import clip_fields, fields
from app.services.clips.merging import OnConflict, merge
from app.services.clips.recordings import NewRecording, attached, stage
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store import audit
from app.store.clips import license_policy
from app.store.clips import listing as clip_listing
from app.store.clips import repository as stored
from app.store.clips.filter import ClipFilter
from app.store.clips.record import (
    AddOutcome,
    AddResult,
    AttachedAudio,
    ClipChanges,
    ClipRecord,
    Difference,
    NewClip,
)
from app.store.database.engine import Tx
from app.store.database.paging import Page
from app.store.files.files import Readable, StagedFile
from app.store.jobs import outcomes, removals
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobRecord, NewJob

UPLOAD_PRIORITY = 10
BULK_PRIORITY = 20
"""For clips of an import and for repeated analyses. The lowest number goes first."""
WORKER_DEATHS = 30
"""How often a job is tried again after the death of its worker, without progress in between. The
clip is seldom the cause: a child process parses its content, and `job_max_attempts` limits the
deaths of that."""
FIXED_HINTS = (clip_fields.UNIT, "roles")
"""Hints that a client can give only with the file, and not change later."""
PATCHABLE = (*clip_fields.LABELS, *(hint for hint in clip_fields.HINTS if hint not in FIXED_HINTS))


@dataclass(frozen=True, slots=True)
class Created:
    """The result of adding a file.

    clip: the clip of its content; job: analyzes the clip, None if it needs no analysis; is_new:
    False if a clip with the same content existed and needed no analysis; differences: of the labels
    and hints that came now from those of a clip that existed.
    """

    clip: ClipRecord
    job: JobRecord | None
    is_new: bool
    differences: tuple[Difference, ...] = ()


@dataclass(frozen=True, slots=True)
class StoredFile:
    """A stored file: its path, the name that it came with, its size in bytes, its SHA-256."""

    path: Path
    name: str
    size: int
    sha256: str


def create_clip(
    lib: Library,
    content: Readable,
    filename: str,
    values: Mapping[str, Any] | None = None,
    *,
    skeleton: Readable | None = None,
    recording: NewRecording | None = None,
    path: str | None = None,
    on_conflict: OnConflict = OnConflict.KEEP,
) -> Created:
    """Store a file durably and queue its analysis; on return both survive kill -9.

    values: the client's labels and hints, as `clip_fields.checked` takes them; skeleton: the ASF
    file of an AMC file; recording: a file of sound; path: where the file was in its folder. If the
    same bytes (of motion and skeleton) are sent again, the result is the existing clip;
    on_conflict: what happens if its labels or hints differ. That clip is queued again if it had
    failed, or if it comes with another recording, which replaces the old one. Raises BadField,
    EmptyFile, UnknownFormat, TooLarge, DiskFull, Conflict; then nothing is stored.
    """
    file_name = fields.file_name(filename)
    # Before the bytes are read: a wrong label must not cost an upload.
    said = clip_fields.sent_values(values or {}, fields.stem(file_name))
    tidy_path = fields.path(path)
    limit = lib.settings.max_upload_bytes
    with ExitStack() as files:
        staged = files.enter_context(lib.store.files.stage(content, max_bytes=limit))
        format = check_content(staged)
        if said.hints.stack is not None:
            check_stack_belongs(format)
        companion = None
        if skeleton is not None:
            companion = files.enter_context(lib.store.files.stage(skeleton, max_bytes=limit))
            _check_pair(format, companion)
        sound: StagedFile | None = None
        audio: AttachedAudio | None = None
        if recording is not None:
            sound = files.enter_context(stage(lib, recording))
            audio = attached(sound, recording.filename)
        new = NewClip(
            sha256=staged.sha256,
            file_name=file_name,
            file_size=staged.size,
            labels=said.labels,
            hints=said.hints,
            skeleton_sha256=None if companion is None else companion.sha256,
            audio=audio,
            path=tidy_path,
            sent=said.sent,
        )
        with lib.store.write() as tx:
            keep(staged, companion, sound)
            return add(tx, new, on_conflict=on_conflict)


def keep(*files: StagedFile | None) -> None:
    """Keep the files that are not None, in the transaction that refers to them."""
    for file in files:
        if file is not None:
            file.keep()


def add(
    tx: Tx,
    new: NewClip,
    priority: int = UPLOAD_PRIORITY,
    on_conflict: OnConflict = OnConflict.KEEP,
    paths: Collection[str] = (),
) -> Created:
    """Add the clip of a stored file and queue its analysis, in the caller's transaction.

    paths: of all files that come together. If the clip exists, its labels and hints are merged with
    the new ones. If it gets another recording, the old one is removed after the commit. Raises
    Conflict, which must undo the transaction.
    """
    added: AddResult = stored.add_or_get(tx, new)
    audit.note(clip_id=added.clip.id)
    if added.outcome is AddOutcome.ADDED:
        return Created(added.clip, enqueue_ingest(tx, added.clip.id, priority), is_new=True)
    merged = merge(added.clip, new, on_conflict, paths)
    clip = _changed(tx, added.clip, merged.changes)
    has_other_input = clip.analysis_input != added.clip.analysis_input
    job = None
    if added.needs_analysis or has_other_input:
        job = enqueue_ingest(tx, clip.id, priority)
        clip = stored.requeue(tx, clip.id)
        removals.record(tx, [added.replaced_audio])
    return Created(clip, job, added.needs_analysis, merged.differences)


def _changed(tx: Tx, clip: ClipRecord, changes: ClipChanges) -> ClipRecord:
    """Change a clip, if there are any changes. Raises BadField for too many keys of metadata."""
    if not changes:
        return clip
    after = stored.patch(tx, clip.id, changes)
    if len(after.metadata) > clip_fields.MAX_META_KEYS:
        message = f"the clip would have more than {clip_fields.MAX_META_KEYS} keys"
        raise fields.bad_field("metadata", message)
    return after


def check_content(staged: StagedFile) -> str:
    """The name of the content's format. Raises EmptyFile, and UnknownFormat if no reader knows
    it."""
    if staged.size == 0:
        raise EmptyFile()
    with staged.open() as file:
        return _format_of(file)


def _format_of(file: BinaryIO) -> str:
    """The name of the format, from the first bytes of a file and the last bytes of a long one."""
    content = file.read(HEAD_BYTES + TAIL_BYTES)
    if file.seek(0, os.SEEK_END) > len(content):
        file.seek(-TAIL_BYTES, os.SEEK_END)
        content = content[:HEAD_BYTES] + file.read()
    return sniff(content)


def _check_pair(format: str, skeleton: StagedFile) -> None:
    if format != "amc":
        raise fields.bad_field("skeleton", f"is for an AMC file, not for {format.upper()}")
    try:
        found = check_content(skeleton)
    except BadContent as problem:
        raise fields.bad_field("skeleton", f"must be an ASF file: {problem.detail}") from problem
    if found != "asf":
        raise fields.bad_field("skeleton", f"must be an ASF file, not {found.upper()}")


def enqueue_ingest(tx: Tx, clip_id: str, priority: int) -> JobRecord:
    """Queue a clip's analysis. If one is queued already, this returns its job."""
    return jobs.enqueue(
        tx,
        NewJob(
            JobKind.INGEST,
            clip_id=clip_id,
            priority=priority,
            max_attempts=WORKER_DEATHS,
            dedupe_key=f"ingest:{clip_id}",
        ),
    )


def list_clips(
    lib: Library,
    filter: ClipFilter | None = None,
    sort: str = "-created_at",
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ClipRecord]:
    """One page of the clips that pass a filter, with the number of them. Raises BadField for a
    bad sort or cursor."""
    passing = resolved_filter(lib, filter)
    with lib.store.read() as tx:
        page = clip_listing.list_clips(tx, passing, sort=sort, limit=limit, cursor=cursor)
        return page.counted(clip_listing.total(tx, passing))


def get_clip(lib: Library, clip_id: str) -> ClipRecord:
    """A clip by id; raises ClipNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, clip_id)


def shown_version(lib: Library, clip_id: str) -> int | None:
    """A number that grows with each change of what views of a ready clip show.

    None if the clip does not exist or is not ready.
    """
    with lib.store.read() as tx:
        return stored.searched_version(tx, clip_id)


def update_clip(lib: Library, clip_id: str, changes: Mapping[str, Any]) -> ClipRecord:
    """Change labels and hints (PATCHABLE). After a change of a hint the clip is analyzed again.

    A field without a key stays as it is; None removes a value. The same holds for each key of
    `metadata`. Raises BadField, ClipNotFound.
    """
    tidy = _checked_changes(changes)
    if tidy.get("stack") is not None:
        with lib.store.files.open(get_clip(lib, clip_id).sha256) as file:
            check_stack_belongs(_format_of(file))
    with lib.store.write() as tx:
        audit.note(fields=sorted(tidy))
        before = stored.get(tx, clip_id)
        after = _changed(tx, before, tidy)
        if after.analysis_input == before.analysis_input:
            return after
        enqueue_ingest(tx, clip_id, BULK_PRIORITY)
        return stored.requeue(tx, clip_id)


def delete_clip(lib: Library, clip_id: str) -> None:
    """Remove a clip, its arrays and its files. Raises ClipNotFound."""
    lib.store.write_even_when_full(lambda tx: outcomes.remove_clip(tx, clip_id))


def open_file(lib: Library, clip_id: str) -> StoredFile:
    """The original file of a clip in any state.

    Raises ClipNotFound, FileDamaged, LicenseNotAllowed.
    """
    clip = get_clip(lib, clip_id)
    license_policy.check(clip.license)
    path = lib.store.files.checked_path(clip.sha256)
    return StoredFile(path, clip.file_name, clip.file_size, clip.sha256)


def open_recording(lib: Library, clip_id: str) -> StoredFile:
    """The file of a clip's recording. Raises the errors of `open_file`, and NotFound if the clip
    has no recording."""
    clip = get_clip(lib, clip_id)
    license_policy.check(clip.license)
    audio = _recording_of(clip)
    path = lib.store.files.checked_path(audio.sha256)
    return StoredFile(path, audio.name, audio.size, audio.sha256)


def remove_recording(lib: Library, clip_id: str) -> ClipRecord:
    """Remove a clip's recording and queue a new analysis. Raises ClipNotFound, NotFound."""

    def remove(tx: Tx) -> ClipRecord:
        audio = _recording_of(stored.get(tx, clip_id))
        stored.patch(tx, clip_id, {"audio": None, "audio_offset": None})
        removals.record(tx, [audio.sha256])
        enqueue_ingest(tx, clip_id, BULK_PRIORITY)
        return stored.requeue(tx, clip_id)

    return lib.store.write_even_when_full(remove)


def _recording_of(clip: ClipRecord) -> AttachedAudio:
    if clip.audio is None:
        raise NotFound(f"The clip {clip.id} has no recording.")
    return clip.audio


def _checked_changes(changes: Mapping[str, Any]) -> ClipChanges:
    for field in changes:
        if field not in PATCHABLE:
            allowed = ", ".join(PATCHABLE)
            raise fields.bad_field(field, f"cannot be changed; fields that can: {allowed}")
    tidy = clip_fields.checked(changes)
    if "name" in tidy and tidy["name"] is None:
        raise fields.bad_field("name", "must not be empty")
    return tidy
