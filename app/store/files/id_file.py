"""The small file in the folder of files that holds the id of the library."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from app.store.files.locked_file import create_locked
from app.store.folders import make_private, make_private_synced, sync_folder

NAME = "library-id"


def read_id(folder: Path) -> str | None:
    """The id of the library that the folder belongs to; None if it holds no id.

    Raises OSError if the file cannot be read.
    """
    try:
        return (folder / NAME).read_text(encoding="ascii", errors="replace").strip() or None
    except FileNotFoundError:
        return None


def write_id(folder: Path, library_id: str, *, replaces: bool = False) -> None:
    """Writes the id completely and synced, or not at all; makes a missing folder.

    Without `replaces`, an existing id stays: if two libraries take the folder at the same time, the
    first one wins, and the other one finds out when it reads the id. Raises OSError.
    """
    make_private(folder.parent)
    make_private_synced(folder)
    temporary, file = create_locked(folder, "id")
    try:
        with file:
            file.write(f"{library_id}\n".encode("ascii"))
            file.flush()
            os.fsync(file.fileno())
        _rename(temporary, folder / NAME, replaces=replaces)
    finally:
        temporary.unlink(missing_ok=True)
    sync_folder(folder)


def _rename(temporary: Path, final: Path, *, replaces: bool) -> None:
    if replaces:
        temporary.replace(final)
        return
    with suppress(FileExistsError):
        try:
            final.hardlink_to(temporary)  # it fails if the name exists; a rename does not
        except (PermissionError, NotImplementedError):  # the file system has no hard links
            if not final.exists():
                temporary.replace(final)
