"""Opens a ZIP archive, but refuses one whose directory needs too much memory.

`zipfile` reads the whole directory of an archive and makes an object of each entry, and only then
can a caller count the entries. A directory of 400 MB would need some gigabytes of memory.
"""

from __future__ import annotations

import os
import struct
import zipfile
from typing import BinaryIO

from app.errors import TooLarge
from app.kinedex_error import Place

HEADER_BYTES = 46
"""Bytes of a directory entry before its name, extra fields and comment (APPNOTE 4.3.12)."""
_LENGTHS = struct.Struct("<HHH")
"""The lengths of the name, the extra fields and the comment, in bytes."""
_LENGTHS_AT = 28
_SIGNATURE = b"PK\x01\x02"
MAX_ENTRY_BYTES = 640
"""Upper limit of the mean size of a directory entry with its name."""
MAX_ENTRIES_PER_FILE = 3
"""An archive may have this many entries for each file that an import may take: folders and hidden
files are entries too."""


def open_zip(archive: BinaryIO, max_files: int) -> zipfile.ZipFile:
    """The archive, open for reading. The caller closes `archive` after it.

    max_files: the number of files that an import may take. Raises TooLarge if the directory has
    too many entries or bytes for them, and the errors of `zipfile` for other content.
    """
    guard = _DirectoryGuard(archive, max_files)
    opened = zipfile.ZipFile(guard)
    guard.is_open = True
    return opened


class _DirectoryGuard:
    """A file that checks an archive's directory before `zipfile` reads it in one piece."""

    def __init__(self, file: BinaryIO, max_files: int) -> None:
        self._file, self._max_files = file, max_files
        self.is_open = False
        self.seek, self.tell, self.seekable = file.seek, file.tell, file.seekable

    def read(self, size: int = -1, /) -> bytes:
        """Read like any file. Raises TooLarge."""
        if not self.is_open and size >= HEADER_BYTES:
            self._check(size)
        return self._file.read(size)

    def _check(self, size: int) -> None:
        """Count the directory entries in the next `size` bytes, with one header in memory."""
        start = self._file.tell()
        left, count = size, 0
        while left >= HEADER_BYTES:
            header = self._file.read(HEADER_BYTES)
            if not header.startswith(_SIGNATURE) or len(header) < HEADER_BYTES:
                break  # not a directory, or a damaged one: zipfile raises the error
            variable_bytes = sum(_LENGTHS.unpack_from(header, _LENGTHS_AT))
            self._file.seek(variable_bytes, os.SEEK_CUR)
            left -= HEADER_BYTES + variable_bytes
            count += 1
            if count > MAX_ENTRIES_PER_FILE * self._max_files:
                raise _too_large(
                    f"more than {count - 1} entries, including folders and hidden files"
                )
        if count and size > MAX_ENTRY_BYTES * max(self._max_files, 1000):
            raise _too_large(f"{size} bytes of names of files")
        self._file.seek(start)


def _too_large(message: str) -> TooLarge:
    return TooLarge("The archive holds too many files.", places=[Place("archive", message)])
