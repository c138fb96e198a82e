"""The recordings that go with motions.

A recording is stored like a clip's own file, by its SHA-256, and is removed with the last clip
that refers to it. Only the analysis decodes it: a clip whose recording cannot be read becomes
ready with a warning.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass

from app.errors import BadContent
from app.formats.audio.reader import HEAD_BYTES, sniff_audio
from app.services import fields
from app.services.library.library import Library
from app.store.clips.record import AttachedAudio
from app.store.files.files import Readable, StagedFile


@dataclass(frozen=True, slots=True)
class NewRecording:
    """A recording that a client sends, and its file name."""

    content: Readable
    filename: str


def stage(lib: Library, recording: NewRecording) -> AbstractContextManager[StagedFile]:
    """Write the recording to a temporary file. Raises TooLarge, DiskFull."""
    return lib.store.files.stage(recording.content, max_bytes=lib.settings.max_upload_bytes)


def attached(staged: StagedFile, filename: str) -> AttachedAudio:
    """The recording as a part of its clip's record.

    Raises BadField if the first bytes are of no known sound format.
    """
    with staged.open() as file:
        try:
            sniff_audio(file.read(HEAD_BYTES))
        except BadContent as problem:
            raise fields.bad_field("audio", problem.detail) from problem
    return AttachedAudio(staged.sha256, fields.file_name(filename), staged.size)
