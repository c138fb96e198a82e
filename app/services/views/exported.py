"""Exported files. The module imports nothing slow, because commands use it without a library."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePath


@dataclass(frozen=True, slots=True)
class Export:
    """A file: its name, and its content in pieces."""

    file_name: str
    blocks: Iterable[bytes]


@dataclass(frozen=True, slots=True)
class ClipExport:
    """The file of a clip, or the reason why there is none."""

    clip_id: str
    file: Export | None
    reason: str | None = None


class FileNames:
    """The names of the files in one folder: no two are equal, in upper or lower case."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def free(self, name: str, clip_id: str) -> str:
        """The name of a clip's file, with the id of the clip in it if another file has the name."""
        if name.casefold() in self._taken:
            path = PurePath(name)
            name = f"{path.stem}-{clip_id}{path.suffix}"
        self._taken.add(name.casefold())
        return name
