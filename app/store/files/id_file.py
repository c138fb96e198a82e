"""The small file in the folder of files that says to which library it belongs."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from app.store.files.locked_file import create_locked
from app.store.folders import make_private, make_private_synced, sync_folder

NAME = "library-id"


def read_id(folder: Path) -> str | None:
    """The id of the library that the folder belongs to; None where it says nothing.

    Raises OSError where that cannot be read.
    """
    try:
        return (folder / NAME).read_text(encoding="ascii", errors="replace").strip() or None
    except FileNotFoundError:
        return None


def write_id(folder: Path, library_id: str, *, replaces: bool = False) -> None:
    """Writes the id, whole and synced or not at all; makes the folder where there is none.

    An id that is there stays, unless `replaces`: of two libraries that take the folder at once,
    one wins, and the other one reads so. Raises OSError.
    """
    make_private(folder.parent)
    make_private_synced(folder)
    temporary, file = create_locked(folder, "id")
    try:
        with file:
            file.write(f"{library_id}\n".encode("ascii"))
            file.flush()
            os.fsync(file.fileno())
        _name(temporary, folder / NAME, replaces=replaces)
    finally:
        temporary.unlink(missing_ok=True)
    sync_folder(folder)


def _name(temporary: Path, final: Path, *, replaces: bool) -> None:
    if replaces:
        temporary.replace(final)
        return
    with suppress(FileExistsError):
        try:
            final.hardlink_to(temporary)
        except (PermissionError, NotImplementedError):  # a disk without hard links
            if not final.exists():
                temporary.replace(final)
