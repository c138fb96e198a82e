"""Writing the files that commands make."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from app.errors import BadField, Place


def write_whole(path: Path, blocks: Iterable[bytes]) -> int:
    """Write beside the target, then rename: what was there stays until all is written.

    Returns how many bytes; raises BadField.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("wb") as written:
            size = sum(written.write(block) for block in blocks)
        part.replace(path)
    except OSError as problem:
        message = f"{path} cannot be written: {problem.strerror}"
        raise BadField(f"output: {message}", places=[Place("output", message)]) from None
    finally:
        part.unlink(missing_ok=True)
    return size
