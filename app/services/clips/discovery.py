"""What a library can be filtered by besides its labels: keys of the metadata, and folders."""

from __future__ import annotations

from app.services import fields
from app.services.library.library import Library
from app.store.clips import folders as stored_folders
from app.store.clips import metadata_keys
from app.store.clips.folders import Folder
from app.store.clips.metadata_keys import MetadataKey
from app.store.database.paging import Page, Position, read_cursor, write_cursor

MAX_VALUES = 10
"""Values that are shown of each key."""
_SORT = "folder"


def metadata(lib: Library, limit: int, cursor: str | None = None) -> Page[MetadataKey]:
    """One page of the keys of the metadata, by name. Raises PageNotFound for a bad cursor."""
    with lib.store.read() as tx:
        return metadata_keys.page(tx, MAX_VALUES, limit, cursor)


def folders(
    lib: Library, parent: str | None, limit: int, cursor: str | None = None
) -> Page[Folder]:
    """One page of the folders directly in a folder (None: the root), by name.

    Raises PageNotFound for a bad cursor, BadField for a bad path.
    """
    after = None if cursor is None else str(read_cursor(cursor, _SORT, str).value)
    with lib.store.read() as tx:
        found = stored_folders.level(tx, fields.path(parent) or "")
    rest = [folder for folder in found if after is None or folder.name > after]
    shown = tuple(rest[:limit])
    has_more = len(rest) > limit
    return Page(shown, write_cursor(_SORT, Position(shown[-1].name, "")) if has_more else None)
