"""Writes the output files of commands."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from app.errors import BadField
from app.kinedex_error import Place


def write_whole(path: Path, blocks: Iterable[bytes]) -> int:
    """Write all blocks to a file. An older file stays until the new one is complete.

    Returns the number of bytes. Raises BadField if the path cannot be written.
    """
    # rename replaces a file in one step, so no reader sees half of it
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("wb") as file:
            size = sum(file.write(block) for block in blocks)
        part.replace(path)
    except OSError as problem:
        message = f"{path} cannot be written: {problem.strerror}"
        raise BadField(f"output: {message}", places=[Place("output", message)]) from None
    finally:
        part.unlink(missing_ok=True)
    return size
