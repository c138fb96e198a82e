"""The recordings that go with motions: what is asked of one that is handed in.

A recording is kept as a clip's own file is, by its SHA-256, and is gone with the last clip
that refers to it. Whether it can be decoded is seen by the analysis: a clip whose recording
cannot be read becomes ready all the same, with a warning.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

from app.errors import BadContent
from app.formats.audio.reader import HEAD_BYTES, sniff_audio
from app.services import fields
from app.services.library.library import Library
from app.store.files.files import Readable, StagedFile


@dataclass(frozen=True, slots=True)
class NewRecording:
    """A recording that a client hands in, and the name it came with."""

    content: Readable
    filename: str


def stage(lib: Library, recording: NewRecording) -> AbstractContextManager[StagedFile]:
    """Its bytes on disk, not kept yet. Raises TooLarge, DiskFull."""
    return lib.store.files.stage(recording.content, max_bytes=lib.settings.max_upload_bytes)


def described(staged: StagedFile, filename: str) -> dict[str, Any]:
    """The fields of a clip's row. Raises BadField for what is no recording by its first bytes."""
    with staged.open() as file:
        try:
            sniff_audio(file.read(HEAD_BYTES))
        except BadContent as problem:
            raise fields.bad_field("audio", problem.detail) from problem
    return {
        "audio_sha256": staged.sha256,
        "audio_name": fields.file_name(filename),
        "audio_size": staged.size,
    }
