"""Opening a ZIP archive whose directory is not larger than what memory should hold.

`zipfile` reads the directory of an archive in one piece and makes an object of each entry, before
anybody can look at how many there are: 400 MB of it would take some gigabytes.
"""

from __future__ import annotations

import os
import struct
import zipfile
from typing import BinaryIO

from app.errors import Place, TooLarge

HEADER_BYTES = 46
"""Of an entry in the directory, before its name, extra fields and comment (APPNOTE 4.3.12)."""
_LENGTHS = struct.Struct("<HHH")
_LENGTHS_AT = 28
_SIGNATURE = b"PK\x01\x02"
ENTRY_BYTES = 640
"""Most bytes of a directory entry, on average, with its name."""
OTHERS = 3
"""An archive may hold so many times the files that are taken: folders, and hidden files."""


def open_zip(archive: BinaryIO, most_files: int) -> zipfile.ZipFile:
    """The archive, for reading; the caller closes `archive` after it.

    Raises TooLarge where its directory has too many entries or bytes for `most_files` files,
    and what `zipfile` raises where it is no archive.
    """
    guard = _Guard(archive, most_files)
    opened = zipfile.ZipFile(guard)
    guard.is_open = True
    return opened


class _Guard:
    """A file that looks through an archive's directory before it gives that in one piece."""

    def __init__(self, file: BinaryIO, most_files: int) -> None:
        self._file, self._most_files = file, most_files
        self.is_open = False
        self.seek, self.tell, self.seekable = file.seek, file.tell, file.seekable

    def read(self, size: int = -1, /) -> bytes:
        """As of any file. Raises TooLarge."""
        if not self.is_open and size >= HEADER_BYTES:
            self._check(size)
        return self._file.read(size)

    def _check(self, size: int) -> None:
        start = self._file.tell()
        left, count = size, 0
        while left >= HEADER_BYTES:
            header = self._file.read(HEADER_BYTES)
            if not header.startswith(_SIGNATURE) or len(header) < HEADER_BYTES:
                break  # no directory, or a damaged one: zipfile says so
            more = sum(_LENGTHS.unpack_from(header, _LENGTHS_AT))
            self._file.seek(more, os.SEEK_CUR)
            left -= HEADER_BYTES + more
            count += 1
            if count > OTHERS * self._most_files:
                raise _too_large(f"more than {count - 1} entries, folders and hidden files too")
        if count and size > ENTRY_BYTES * max(self._most_files, 1000):
            raise _too_large(f"{size} bytes of names of files")
        self._file.seek(start)


def _too_large(message: str) -> TooLarge:
    return TooLarge("The archive holds too many files.", places=[Place("archive", message)])
