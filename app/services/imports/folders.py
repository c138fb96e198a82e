"""The files of a folder of this machine, without those of a library that lies below it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from app.services.fields import bad_field

DATABASE = "kinedex.sqlite3"
"""The file that makes a folder the folder of a library: a data directory or a backup."""
LEFT_OUT = "This folder holds a library of Kinedex, which an import leaves out."


@dataclass(frozen=True, slots=True)
class FolderContent:
    """Paths below a folder. files: sorted by path, without hidden files and links to folders;
    libraries: folders of libraries. No file is in one of them."""

    files: tuple[Path, ...]
    libraries: tuple[Path, ...]


def content_of(folder: Path, own: Path | None = None) -> FolderContent:
    """The content of a folder. own: the data directory of the library that imports.

    A library keeps the files of its clips, so an import of them would add each clip once more.
    Raises BadField if the folder itself is in a library.
    """
    library = None if own is None else own.resolve()
    if _is_library(folder, library) or (library and library in folder.resolve().parents):
        raise bad_field("path", f"{folder} is the folder of a library of Kinedex, not of motions")
    files, libraries = [], []
    for root, folders, names in os.walk(folder):
        base = Path(root)
        below = [base / name for name in sorted(folders) if not name.startswith(".")]
        left_out = [one for one in below if _is_library(one, library)]
        folders[:] = [one.name for one in below if one not in left_out]
        libraries += left_out
        files += [base / name for name in sorted(names) if not name.startswith(".")]
    return FolderContent(tuple(files), tuple(libraries))


def _is_library(folder: Path, own: Path | None) -> bool:
    return (folder / DATABASE).is_file() or folder.resolve() == own
