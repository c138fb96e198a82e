"""What calls send: fields that may be left out, and files with the progress of their upload."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from enum import Enum
from pathlib import Path
from typing import IO, Any, Final, TypeAlias, cast


class Unset(Enum):
    """The type of UNSET."""

    UNSET = "unset"


UNSET: Final = Unset.UNSET
"""The value of a field that is not sent. In a correction, None deletes a value."""

FileInput: TypeAlias = str | os.PathLike[str] | bytes | IO[bytes] | tuple[str, bytes | IO[bytes]]
"""A file to upload: its path, its bytes, an open binary file, or a pair (file name, content)."""

Progress: TypeAlias = Callable[[int, int], None]
"""Called with the bytes that were sent so far and the bytes in total."""

Files: TypeAlias = dict[str, tuple[str, Any]]
"""Pairs of a file name and a binary stream."""


def given(**fields: Any) -> dict[str, Any]:
    """The fields that are neither None nor UNSET."""
    return {
        name: value for name, value in fields.items() if value is not None and value is not UNSET
    }


def corrections(**fields: Any) -> dict[str, Any]:
    """The fields that are not UNSET. None deletes a value."""
    return {name: value for name, value in fields.items() if value is not UNSET}


def form_text(value: Any) -> str:
    """A field of a form as text: objects and lists of objects as JSON, others with spaces."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return json.dumps(value)
    if isinstance(value, list | tuple) and any(isinstance(one, Mapping) for one in value):
        return json.dumps(value)
    if isinstance(value, list | tuple | set | frozenset):
        return " ".join(form_text(one) for one in value)
    return str(value)


def query_texts(query: Mapping[str, Any]) -> dict[str, str | list[str]]:
    """The parameters of an address as texts; a list repeats its parameter."""
    return {
        name: [form_text(one) for one in value]
        if isinstance(value, list | tuple | set | frozenset)
        else form_text(value)
        for name, value in query.items()
    }


@contextmanager
def opened(files: Mapping[str, FileInput], progress: Progress | None) -> Iterator[Files]:
    """Open the files of a call as pairs of a name and a binary stream.

    Files that were opened here are closed at the end. Raises OSError.
    """
    with ExitStack() as stack:
        streams = {name: _stream(file, stack) for name, file in files.items()}
        if progress is not None:
            total = sum(_size(stream) for _, stream in streams.values())
            count = _Count(progress, total)
            streams = {
                k: (n, cast("IO[bytes]", _Counted(s, count))) for k, (n, s) in streams.items()
            }
        yield streams


def is_repeatable(files: Mapping[str, FileInput]) -> bool:
    """Whether every file can be sent a second time."""
    contents = [file[1] if isinstance(file, tuple) else file for file in files.values()]
    return all(isinstance(one, str | bytes | os.PathLike) or one.seekable() for one in contents)


def _stream(file: FileInput, stack: ExitStack) -> tuple[str, IO[bytes]]:
    if isinstance(file, tuple):
        name, content = file
        return name, io.BytesIO(content) if isinstance(content, bytes) else _from_start(content)
    if isinstance(file, bytes):
        return "file", io.BytesIO(file)
    if isinstance(file, str | os.PathLike):
        path = Path(file)
        return path.name, stack.enter_context(path.open("rb"))
    return Path(str(getattr(file, "name", "file"))).name, _from_start(file)


def _from_start(stream: IO[bytes]) -> IO[bytes]:
    if stream.seekable():
        stream.seek(0)
    return stream


def _size(stream: IO[bytes]) -> int:
    size = stream.seek(0, os.SEEK_END) if stream.seekable() else 0
    _from_start(stream)
    return size


class _Count:
    """The bytes of all files of one call that were read so far."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._total = total
        self._done = 0

    def add(self, size: int) -> None:
        self._done += size
        self._progress(self._done, max(self._total, self._done))


class _Counted(io.RawIOBase):
    """A stream that counts the bytes that are read from it. It does not close its source."""

    def __init__(self, source: IO[bytes], count: _Count) -> None:
        self._source = source
        self._count = count

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return self._source.seekable()

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        return self._source.seek(offset, whence)

    def tell(self) -> int:
        return self._source.tell()

    def read(self, size: int = -1) -> bytes:
        block = self._source.read(size)
        self._count.add(len(block))
        return block
