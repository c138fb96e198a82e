"""Objects of one bucket below one prefix, by obstore. Failures become those of the file store.

Each request is tried again for at most RETRY_S, because a write transaction may wait for it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import obstore
from obstore.exceptions import AlreadyExistsError, BaseError
from obstore.store import S3Store

from app.errors import ConfigurationError, DiskFull, NotFound, StorageError
from app.store.files.bucket import Bucket

if TYPE_CHECKING:
    from obstore.store import S3Config

REQUEST_S, RETRY_S = timedelta(seconds=60), timedelta(seconds=20)
"""Longest time of one request, and of all tries of one."""
PART_BYTES = 8 * 2**20
"""Larger files are sent in parts of this size."""
READ_BYTES = 2**20
_NO_SPACE = ("QuotaExceeded", "XMinioStorageFull", "InsufficientStorage", "507 ")
"""What stores say when nothing more fits in."""
_REASON_LENGTH = 200


@dataclass(frozen=True, slots=True)
class ObjectInfo:
    """An object without its bytes. modified: by the clock of the store."""

    name: str
    size: int
    modified: datetime


class Objects:
    """The objects of a bucket. All methods raise StorageError, and those that write DiskFull."""

    def __init__(self, bucket: Bucket) -> None:
        """Raises ConfigurationError for a URL that names no bucket."""
        self._store = _opened(bucket)

    def create(self, name: str, content: bytes) -> bool:
        """Writes a new object; returns False, and changes nothing, if there is one already."""
        try:
            with _failures(name):
                obstore.put(self._store, name, content, mode="create", use_multipart=False)
        except AlreadyExistsError:
            return False
        return True

    def replace(self, name: str, content: bytes) -> None:
        """Writes an object, whether there is one or not."""
        with _failures(name):
            obstore.put(self._store, name, content, use_multipart=False)

    def upload(self, name: str, path: Path) -> None:
        """Writes an object from a file, a large one in parts. The object is complete or absent."""
        with _failures(name), path.open("rb") as file:
            obstore.put(self._store, name, file, chunk_size=PART_BYTES)

    def read(self, name: str) -> Iterator[bytes]:
        """The bytes of an object, in pieces. Raises NotFound."""
        with _failures(name):
            yield from obstore.get(self._store, name).stream(min_chunk_size=READ_BYTES)

    def find(self, name: str) -> ObjectInfo | None:
        """An object, or None if there is none."""
        try:
            with _failures(name):
                found = obstore.head(self._store, name)
        except NotFound:
            return None
        return ObjectInfo(name, found["size"], found["last_modified"])

    def copy(self, source: str, target: str) -> None:
        """Copies an object within the bucket. Raises NotFound."""
        with _failures(source):
            obstore.copy(self._store, source, target)

    def remove(self, name: str) -> None:
        """Removes an object, if there is one."""
        try:
            with _failures(name):
                obstore.delete(self._store, name)
        except NotFound:
            return

    def below(self, folder: str = "") -> Iterator[ObjectInfo]:
        """All objects whose names begin with a folder; "": all."""
        with _failures(folder):
            for batch in obstore.list(self._store, folder or None):
                for one in batch:
                    yield ObjectInfo(one["path"], one["size"], one["last_modified"])


def _opened(bucket: Bucket) -> S3Store:
    if not bucket.url.startswith("s3://"):
        raise ConfigurationError("KINEDEX_FILES_URL must begin with s3://")
    config: S3Config = {}
    if bucket.endpoint is not None:
        config["endpoint"] = bucket.endpoint
    if bucket.region is not None:
        config["region"] = bucket.region
    if bucket.access_key is not None and bucket.secret_key is not None:
        config["access_key_id"] = bucket.access_key
        config["secret_access_key"] = bucket.secret_key
    try:
        return S3Store.from_url(
            bucket.url,
            config=config,
            client_options={"allow_http": True, "timeout": REQUEST_S},
            retry_config={"retry_timeout": RETRY_S},
        )
    except (BaseError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise ConfigurationError(f"KINEDEX_FILES_URL names no bucket: {reason}") from error


@contextmanager
def _failures(name: str) -> Iterator[None]:
    try:
        yield
    except AlreadyExistsError:
        raise
    except FileNotFoundError as error:
        if "NoSuchBucket" in str(error):
            raise StorageError("The bucket of files does not exist") from error
        raise NotFound(f"The object {name} is not in the bucket") from error
    except (BaseError, OSError) as error:
        if any(word in str(error) for word in _NO_SPACE):
            raise DiskFull() from error
        # The first line only: what follows names keys and hosts.
        reason = str(error).splitlines()[0][:_REASON_LENGTH]
        raise StorageError(f"The bucket of files failed: {reason}") from error
