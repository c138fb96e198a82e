"""The folders that the files of clips were in, one level at a time."""

from __future__ import annotations

from dataclasses import dataclass, field

from sqlalchemy import func, select

from app.store.clips.filter import in_folder
from app.store.database.engine import Tx
from app.store.database.tables import clips


@dataclass(slots=True)
class Folder:
    """A folder. path: from the root; clips: in it and below it; folders: the names of the folders
    directly in it."""

    path: str
    clips: int = 0
    folders: set[str] = field(default_factory=set)

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition("/")[2]

    @property
    def subfolders(self) -> int:
        """The number of folders directly in it."""
        return len(self.folders)


def level(tx: Tx, parent: str) -> tuple[Folder, ...]:
    """The folders directly in a folder, sorted by name; parent: "" is the root.

    A library may have a hundred thousand clips, but it has far fewer folders, and the database
    counts the clips of each.
    """
    is_below = clips.c.folder != "" if not parent else in_folder(parent)
    query = select(clips.c.folder, func.count()).where(is_below).group_by(clips.c.folder)
    found: dict[str, Folder] = {}
    for path, count in tx.execute(query):
        rest = path if not parent else path[len(parent) + 1 :]
        if not rest:
            continue  # clips that are in the parent itself
        name, *deeper = rest.split("/")
        child = f"{parent}/{name}" if parent else name
        folder = found.setdefault(name, Folder(child))
        folder.clips += count
        folder.folders.update(deeper[:1])
    return tuple(found[name] for name in sorted(found))
