"""The progress of a child process: what it wrote last is read, and the file is removed."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.services.children.pool import ChildPool
from app.services.children.processes import log_like_parent
from app.services.children.progress_file import ProgressFile, progress_to


def _count_to(path: str, last: int, total: int) -> None:
    write = progress_to(path)
    for done in range(1, last + 1):
        write(done, total)


def test_the_parent_reads_what_the_child_wrote_last() -> None:
    file = ProgressFile()
    assert file.read() == (0, 0)
    pool = ChildPool(1, log_like_parent, "WARNING")
    try:
        pool.submit(_count_to, file.path, 300, 5_000_000_000).result()
    finally:
        pool.close()
    assert file.read() == (300, 5_000_000_000)
    file.close()
    assert not Path(file.path).exists()


def test_a_late_child_makes_no_file_again() -> None:
    file = ProgressFile()
    file.close()
    with pytest.raises(FileNotFoundError):
        progress_to(file.path)
    assert not Path(file.path).exists()
