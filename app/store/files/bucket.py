"""Where the files of a library are: a folder, or a bucket of an S3-compatible store."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

DEFAULT_CACHE_BYTES = 4 * 2**30


@dataclass(frozen=True, slots=True)
class Bucket:
    """A bucket and how to reach it.

    url: `s3://bucket/prefix`; folder: of this machine, for temporary files and for copies of files
    that are read; cache_bytes: size of these copies; endpoint: URL of a store that is not Amazon's;
    without keys, those of the environment or the role of the machine count.
    """

    url: str
    folder: Path
    endpoint: str | None = None
    region: str | None = None
    access_key: str | None = field(default=None, repr=False)
    secret_key: str | None = field(default=None, repr=False)
    cache_bytes: int = DEFAULT_CACHE_BYTES


FilesPlace = Path | Bucket
