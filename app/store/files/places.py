"""Opens the files of a library, wherever they are."""

from __future__ import annotations

from pathlib import Path

from app.errors import ConfigurationError
from app.store.files.bucket import FilesPlace
from app.store.files.files import FileStore
from app.store.files.local_files import LocalFiles


def open_files(place: FilesPlace, library_id: str | None = None) -> FileStore:
    """The files at a place; library_id: see `FileStore.check_identity`.

    Raises ConfigurationError if the package for buckets is not installed, or the URL names none.
    """
    if isinstance(place, Path):
        return LocalFiles(place, library_id)
    try:
        from app.store.files.object_files import ObjectFiles
    except ImportError as error:
        raise ConfigurationError(
            "KINEDEX_FILES_URL: to use a bucket, install `kinedex[s3]`"
        ) from error
    return ObjectFiles(place, library_id)
