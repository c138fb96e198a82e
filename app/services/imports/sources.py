"""The sources of an import: a ZIP archive, a folder, or single files.

Each source returns a list of `SourceFile`. A file that must not be opened has a problem instead.
No file of an archive is ever written to the path that the archive names.
"""

from __future__ import annotations

import lzma
import os
import stat
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from types import TracebackType
from typing import IO, BinaryIO

from app.errors import BadContent, TooLarge, Unreadable
from app.kinedex_error import KinedexError, Place
from app.services.imports.archive_directory import open_zip
from app.services.imports.folders import LEFT_OUT, content_of
from app.services.imports.skipped import NoMotion

_ENCRYPTED = 0x1
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
_RATIO_COUNTS_FROM = 10 * 2**20
"""Archives of fewer unpacked bytes may have any ratio."""
_READ_FAILURES = (
    OSError,  # bzip2 raises it for bad content
    EOFError,
    RuntimeError,  # includes NotImplementedError
    ValueError,
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
)
"""Exceptions from opening or reading a file or an entry of an archive."""


@dataclass(frozen=True, slots=True)
class ArchiveLimits:
    """Upper limits: number of entries; unpacked size of all, as a multiple of the archive's size;
    bytes of one file."""

    entries: int
    ratio: float
    file_bytes: int


class SourceContent:
    """An open file of an import. All its failures become Unreadable.

    Files are read while they are stored. An OSError would look like a failure of the store.
    """

    def __init__(self, opener: Callable[[], IO[bytes]]) -> None:
        """Open the file. Raises Unreadable."""
        with _read_failures():
            self._file = opener()

    def read(self, size: int = -1, /) -> bytes:
        """The next bytes, at most `size` (-1: all); empty at the end. Raises Unreadable."""
        with _read_failures():
            return self._file.read(size)

    def __enter__(self) -> SourceContent:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()


@dataclass(frozen=True, slots=True)
class SourceFile:
    """One file of an import.

    path: relative, with /; open: opens it, at most once; problem: why it must not be opened.
    """

    path: str
    open: Callable[[], SourceContent]
    problem: KinedexError | None = None


@contextmanager
def archive_files(archive: BinaryIO | Path, limits: ArchiveLimits) -> Iterator[list[SourceFile]]:
    """The files of a ZIP archive, in its order. They can be read within the `with` block.

    A bad entry has a problem. Raises Unreadable if the archive is not a ZIP, and TooLarge if it
    has too many entries or its unpacked size is too large.
    """
    with ExitStack() as files:
        file = files.enter_context(archive.open("rb")) if isinstance(archive, Path) else archive
        try:
            opened = files.enter_context(open_zip(file, limits.entries))
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as problem:
            raise Unreadable(f"The archive cannot be read as ZIP: {problem}.") from problem
        entries = [entry for entry in opened.infolist() if not _is_ignored(entry)]
        _check_archive(entries, _size(file), limits)
        yield [_archive_file(opened, entry, limits) for entry in entries]


def folder_files(folder: Path, own: Path | None = None) -> list[SourceFile]:
    """The files below a folder, as in `content_of`; a library below it has a problem.

    own: the data directory of the library that imports. Raises BadField if the folder is in a
    library.
    """
    content = content_of(folder, own)
    files = [_disk_file(path.relative_to(folder).as_posix(), path) for path in content.files]
    libraries = [
        replace(_disk_file(path.relative_to(folder).as_posix(), path), problem=NoMotion(LEFT_OUT))
        for path in content.libraries
    ]
    return [*files, *libraries]


def single_file(path: Path, companion: Path | None = None) -> list[SourceFile]:
    """One file; companion: a file that it needs, as an AMC file needs its ASF file."""
    files = [path] if companion is None else [path, companion]
    return [_disk_file(file.name, file) for file in files]


def is_archive(path: Path) -> bool:
    """Whether a file is a ZIP archive by its content. NPZ files are ZIPs too, but are motions."""
    return path.is_file() and path.suffix.lower() != ".npz" and zipfile.is_zipfile(path)


def _disk_file(name: str, path: Path) -> SourceFile:
    return SourceFile(name, partial(SourceContent, partial(_open_file, path)))


def _open_file(path: Path) -> IO[bytes]:
    if not stat.S_ISREG(path.stat().st_mode):
        raise Unreadable("This is no regular file.")  # opening a pipe waits for a writer
    return path.open("rb")


@contextmanager
def _read_failures() -> Iterator[None]:
    try:
        yield
    except _READ_FAILURES as problem:
        raise Unreadable(f"The file cannot be read: {problem}.") from problem


def _is_ignored(entry: zipfile.ZipInfo) -> bool:
    """Whether an entry is a folder, a hidden file, or metadata of macOS or version control."""
    parts = _path_of(entry).parts
    hidden = any(part.startswith(".") and part not in (".", "..") for part in parts)
    return entry.is_dir() or "__MACOSX" in parts or hidden


def _path_of(entry: zipfile.ZipInfo) -> PurePosixPath:
    return PurePosixPath(entry.filename.replace("\\", "/"))


def _check_archive(entries: list[zipfile.ZipInfo], size: int, limits: ArchiveLimits) -> None:
    """Raise TooLarge for too many entries or a too large unpacked size; size: of the archive."""
    if len(entries) > limits.entries:
        place = Place("archive", f"{len(entries)} entries, the limit is {limits.entries}")
        raise TooLarge("The archive holds too many files.", places=[place])
    unpacked = sum(entry.file_size for entry in entries)
    if unpacked > max(size * limits.ratio, _RATIO_COUNTS_FROM):
        message = f"{size} bytes would unpack to {unpacked}, more than {limits.ratio:g} times"
        raise TooLarge("The unpacked archive is too large.", places=[Place("archive", message)])


def _archive_file(
    archive: zipfile.ZipFile, entry: zipfile.ZipInfo, limits: ArchiveLimits
) -> SourceFile:
    problem = _entry_problem(entry, limits)
    opener = partial(archive.open, entry)
    return SourceFile(entry.filename, partial(SourceContent, opener), problem)


def _entry_problem(entry: zipfile.ZipInfo, limits: ArchiveLimits) -> KinedexError | None:
    """Why an entry must not be opened; None if it may."""
    where = [Place(entry.filename, "refused")]
    path = _path_of(entry)
    # A colon in the first part is a drive of Windows ("C:/a.bvh").
    if path.is_absolute() or ".." in path.parts or ":" in (path.parts or ("",))[0]:
        return BadContent("The path leads out of the archive.", places=where)
    if stat.S_ISLNK(entry.external_attr >> 16):  # the upper 16 bits are the Unix file mode
        return BadContent("Links in an archive are not followed.", places=where)
    if entry.flag_bits & _ENCRYPTED:
        return BadContent("The entry is encrypted.", places=where)
    if entry.compress_type not in _COMPRESSIONS:
        return BadContent("The entry is compressed by an unknown method.", places=where)
    if entry.file_size > limits.file_bytes:
        message = f"{entry.file_size} bytes, the limit is {limits.file_bytes}"
        return TooLarge("The file is too large.", places=[Place(entry.filename, message)])
    return None


def _size(archive: BinaryIO) -> int:
    position = archive.tell()
    size = archive.seek(0, os.SEEK_END)
    archive.seek(position)
    return size
