"""Files that the parent opens for a task of a child, which may open none itself (`sandbox`).

The parent sends the open files through the pipe of the child. A task opens them by their paths.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import reduction
from multiprocessing.connection import Connection
from pathlib import Path
from typing import BinaryIO

_given: dict[str, int] = {}
"""In a child: the open files of its task, by path."""


@contextmanager
def opened(paths: Sequence[str]) -> Iterator[list[int]]:
    """In the parent: the files, open in the block. Raises OSError."""
    with ExitStack() as files:
        yield [files.enter_context(Path(path).open("rb")).fileno() for path in paths]


def send(pipe: Connection, descriptors: Sequence[int], child: int) -> None:
    """In the parent: send open files to the child process with this id."""
    for descriptor in descriptors:
        reduction.send_handle(pipe, descriptor, child)


@contextmanager
def received(pipe: Connection, paths: Sequence[str]) -> Iterator[None]:
    """In the child: receive the files; the block can open them."""
    try:
        for path in paths:
            _given[path] = reduction.recv_handle(pipe)
        yield
    finally:
        for descriptor in _given.values():
            os.close(descriptor)
        _given.clear()


def open_given(path: str) -> BinaryIO:
    """A file that was given to this task; in a process without tasks, the file at the path.

    Raises OSError.
    """
    if path in _given:
        return os.fdopen(os.dup(_given[path]), "rb")
    return Path(path).open("rb")
