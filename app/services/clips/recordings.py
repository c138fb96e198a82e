"""The recordings that go with motions: what is asked of one that is handed in.

A recording is kept as a clip's own file is, by its SHA-256, and is gone with the last clip
that refers to it. Whether it can be decoded is seen by the analysis: a clip whose recording
cannot be read becomes ready all the same, with a warning.
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
    """A recording that a client hands in, and the name it came with."""

    content: Readable
    filename: str


def stage(lib: Library, recording: NewRecording) -> AbstractContextManager[StagedFile]:
    """Its bytes on disk, not kept yet. Raises TooLarge, DiskFull."""
    return lib.store.files.stage(recording.content, max_bytes=lib.settings.max_upload_bytes)


def attached(staged: StagedFile, filename: str) -> AttachedAudio:
    """The recording as a part of its clip. Raises BadField where its first bytes are not those of
    a recording."""
    with staged.open() as file:
        try:
            sniff_audio(file.read(HEAD_BYTES))
        except BadContent as problem:
            raise fields.bad_field("audio", problem.detail) from problem
    return AttachedAudio(staged.sha256, fields.file_name(filename), staged.size)
