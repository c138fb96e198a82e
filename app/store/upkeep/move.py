"""Moves a library to another database, and its files to another place, while it is in use.

A move goes over all tables in the order of their references, page by page: rows that the target
lacks are inserted, rows that differ are replaced, rows that it has too many are deleted. So a move
that was killed goes on where it was, and a second one takes only what has changed since. Then all
rows are read again on both sides and compared by the SHA-256 of their values, and every file by
that of its bytes.

Until `switch`, the target has an id that no folder of files has, so Kinedex refuses to start on
it. After that, a move to it is refused: it would undo what was changed there.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, NoReturn

from sqlalchemy import (
    Column,
    Row,
    Table,
    and_,
    delete,
    insert,
    inspect,
    literal,
    select,
    tuple_,
    update,
)

from app.errors import BadField, FileDamaged, LibraryMismatch, StorageError
from app.kinedex_error import Place
from app.store.database import collection_tables, schema, service_tables, tables
from app.store.database.columns import metadata
from app.store.database.engine import Database, Tx, without_nul
from app.store.database.tables import clip_arrays, file_removals, library, model_arrays
from app.store.files.bucket import FilesPlace
from app.store.files.files import FileStore
from app.store.files.places import open_files
from app.store.jobs import references
from app.store.store import Store
from app.store.upkeep.mend import open_backup

MOVING = "moving_"
"""Before the id of a library whose move is not finished."""
ROWS_AT_ONCE, ARRAYS_AT_ONCE = 500, 50
"""Rows in one page; arrays are large."""

_VERSION_TABLE = "alembic_version"
# The removals of files are of the old place. The library's row comes last, by `switch`.
_LEFT_OUT = {file_removals.name, library.name}
# Together they define the tables: `metadata` has those of modules that somebody imported.
_MODULES = (tables, collection_tables, service_tables)

Progress = Callable[[str, int, int], None]
"""Called with what is done now, and how many of how many steps are done."""
_Key = tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Move:
    """What a move did.

    rows, files: all that the library has; written, removed: rows that it changed in the target;
    copied: files that it copied.
    """

    rows: int
    written: int
    removed: int
    files: int
    copied: int


def move(
    store: Store,
    target: Database,
    files: FileStore | None = None,
    *,
    switch: bool = False,
    progress: Progress | None = None,
) -> Move:
    """Copies the library of `store` into a database with the schema of this version.

    files: where the files go; None if they stay. switch: nobody can change the library meanwhile,
    and then the target is ready to be used. Raises BadField if the target is another library, or
    was switched to already; LibraryMismatch for files of another library; DiskFull; StorageError,
    which names the files that are missing or damaged.
    """
    tell = progress or _tell_nobody
    with _source(store, switch=switch) as source:
        (ours,) = source.execute(select(library)).all()
        _claim(target, ours.library_id)
        if files is not None:
            _claim_files(files, ours.library_id)
        chosen = _tables(source)
        removed = sum(_remove_surplus(source, target, table) for table in reversed(chosen))
        counts = [_copy(source, target, table, tell) for table in chosen]
        _compare(source, target, chosen, tell)
        needed = references.referenced(source)
        copied = 0 if files is None else _copy_files(store.files, files, needed, tell)
        if switch:
            with target.write() as tx:
                tx.execute(update(library).values(version=ours.version, library_id=ours.library_id))
    rows, written = (sum(each[n] for each in counts) for n in range(2))
    return Move(rows, written, removed, len(needed), copied)


def open_target(url: str) -> Database:
    """The database to move to; its tables are made if it is empty. Raises DatabaseOutOfDate."""
    if schema.state(url).is_empty:
        schema.upgrade(url)
    schema.check(url)
    return Database(url)


@contextmanager
def _source(store: Store, *, switch: bool) -> Iterator[Tx]:
    """One snapshot of the library; with `switch`, other writers wait until the end."""
    with store.database.write() if switch else store.read() as tx:
        yield tx


def _claim(target: Database, library_id: str) -> None:
    """Marks the target as the one of this move. Raises BadField if it is something else."""
    with target.write() as tx:
        found = tx.execute(select(library.c.library_id)).scalar_one()
        if found == MOVING + library_id:
            return
        if found == library_id:
            _refuse("url", "the library was moved there already, and may have changed since")
        others = (table for table in metadata.sorted_tables if table is not library)
        if any(tx.execute(select(table).limit(1)).first() is not None for table in others):
            _refuse("url", "it holds another library")
        tx.execute(update(library).values(library_id=MOVING + library_id))


def _claim_files(files: FileStore, library_id: str) -> None:
    if files.read_id() is None and next(iter(files), None) is None:
        files.write_id(library_id)
    found = files.read_id()
    if found != library_id:
        raise LibraryMismatch(f"{files.name} holds the files of the library {found or 'of nobody'}")


def _tables(source: Tx) -> list[Table]:
    """All tables to copy, in the order of their references. Raises StorageError for others."""
    known = {table.name for table in metadata.sorted_tables}
    others = set(inspect(source).get_table_names()) - known - {_VERSION_TABLE}
    if others:
        raise StorageError(f"The database has tables that are not Kinedex's: {sorted(others)}")
    return [table for table in metadata.sorted_tables if table.name not in _LEFT_OUT]


def _copy(source: Tx, target: Database, table: Table, tell: Progress) -> tuple[int, int]:
    """Copies what differs; returns the number of rows, and of those that were written."""
    total = written = 0
    for rows, after, last in _pages(source, table):
        with target.write() as tx:
            theirs = _digests(_between(tx, table, after, last), table)
            new = [row for row in rows if _key(row, table) not in theirs]
            changed = [
                row
                for row in rows
                if _key(row, table) in theirs and theirs[_key(row, table)] != _digest(row)
            ]
            if new:
                tx.execute(insert(table), [_values(row) for row in new])
            for row in changed:
                tx.execute(update(table).where(_is(table, _key(row, table))).values(_values(row)))
        total += len(rows)
        written += len(new) + len(changed)
        tell(table.name, total, total)
    return total, written


def _remove_surplus(source: Tx, target: Database, table: Table) -> int:
    """Deletes the rows of the target that the library has not; returns their number."""
    keys, removed, after = list(table.primary_key), 0, None
    while True:
        with target.write() as tx:
            page = [tuple(row) for row in tx.execute(_page(table, keys, after, ROWS_AT_ONCE))]
            last = page[-1] if len(page) == ROWS_AT_ONCE else None
            ours = {tuple(row) for row in source.execute(_range(table, keys, after, last))}
            surplus = [key for key in page if key not in ours]
            for key in surplus:
                tx.execute(delete(table).where(_is(table, key)))
        removed += len(surplus)
        if last is None:
            return removed
        after = last


def _compare(source: Tx, target: Database, chosen: list[Table], tell: Progress) -> None:
    """Raises StorageError unless both have the same rows."""
    with target.read() as tx:
        for number, table in enumerate(chosen):
            tell("comparing", number, len(chosen))
            for rows, after, last in _pages(source, table):
                ours = _digests(rows, table)
                if ours != _digests(_between(tx, table, after, last), table):
                    raise StorageError(f"The rows of {table.name} differ after the copy: try again")
    tell("comparing", len(chosen), len(chosen))


def _copy_files(source: FileStore, target: FileStore, names: frozenset[str], tell: Progress) -> int:
    """Copies the files that the target lacks, and checks the others; returns how many it copied."""
    lacking, places = target.missing(names), []
    for done, sha256 in enumerate(sorted(names), 1):
        try:
            if sha256 in lacking:
                copy_file(source, target, sha256)
            else:
                target.check(sha256)
        except FileDamaged:
            try:
                copy_file(source, target, sha256)
            except (FileDamaged, BadField):
                places.append(Place(sha256, "is damaged"))
        tell("files", done, len(names))
    if places:
        raise StorageError("Some files of the library are damaged.", places=places)
    return len(lacking)


def restore_files_to(place: FilesPlace, backup: Path) -> int:
    """Copies the files of a backup to an empty place, or to one with the same id.

    Returns the number of files there. Raises BadField if the backup has none; LibraryMismatch;
    DiskFull; StorageError.
    """
    source = open_backup(backup)
    library_id = source.read_id()
    if library_id is None:
        _refuse("path", f"{backup} does not say to which library its files belong")
    target = open_files(place, library_id)
    _claim_files(target, library_id)
    names = frozenset(source)
    _copy_files(source, target, names, _tell_nobody)
    return len(names)


def copy_file(source: FileStore, target: FileStore, sha256: str) -> None:
    """Copies one file. Raises NotFound, FileDamaged, DiskFull, StorageError."""
    with source.open(sha256) as content, target.stage(content) as staged:
        if staged.sha256 != sha256:
            raise FileDamaged(f"The stored file {sha256} is damaged: restore it from a backup.")
        staged.keep()


def _pages(tx: Tx, table: Table) -> Iterator[tuple[list[Row[Any]], _Key | None, _Key | None]]:
    """The rows in pages, each with the key before its first row, and its last key.

    The last page has None instead of its last key, and may be empty.
    """
    size = ARRAYS_AT_ONCE if table in (clip_arrays, model_arrays) else ROWS_AT_ONCE
    after: _Key | None = None
    while True:
        rows = list(tx.execute(_page(table, list(table.c), after, size)))
        last = _key(rows[-1], table) if len(rows) == size else None
        yield rows, after, last
        if last is None:
            return
        after = last


def _between(tx: Tx, table: Table, after: _Key | None, last: _Key | None) -> list[Row[Any]]:
    return list(tx.execute(_range(table, list(table.c), after, last)))


def _page(table: Table, columns: list[Column[Any]], after: _Key | None, size: int) -> Any:
    return _range(table, columns, after, None).limit(size)


def _range(table: Table, columns: list[Column[Any]], after: _Key | None, last: _Key | None) -> Any:
    """A query for the rows with keys after one and up to another, in their order."""
    key = tuple_(*table.primary_key)
    query = select(*columns).order_by(*table.primary_key)
    if after is not None:
        query = query.where(key > tuple_(*_bound(table, after)))
    return query if last is None else query.where(key <= tuple_(*_bound(table, last)))


def _bound(table: Table, key: _Key) -> list[Any]:
    return [literal(one, column.type) for column, one in zip(table.primary_key, key, strict=True)]


def _is(table: Table, key: _Key) -> Any:
    return and_(*(column == one for column, one in zip(table.primary_key, key, strict=True)))


def _key(row: Row[Any], table: Table) -> _Key:
    return tuple(row._mapping[column] for column in table.primary_key)


def _digests(rows: list[Row[Any]], table: Table) -> dict[_Key, str]:
    return {_key(row, table): _digest(row) for row in rows}


def _digest(row: Row[Any]) -> str:
    """The SHA-256 of all values of a row, which is the same for both kinds of databases."""
    digest = hashlib.sha256()
    for value in _values(row).values():
        if isinstance(value, bytes):
            digest.update(b"%d:" % len(value) + value)
        else:
            digest.update(json.dumps(value, sort_keys=True, default=_text_of).encode() + b"\n")
    return digest.hexdigest()


def _text_of(value: object) -> str:
    return value.isoformat() if isinstance(value, datetime) else str(value)


def _values(row: Row[Any]) -> Mapping[str, Any]:
    return {name: without_nul(value) for name, value in row._mapping.items()}


def _refuse(field: str, message: str) -> NoReturn:
    raise BadField(f"{field}: {message}", places=[Place(field, message)])


def _tell_nobody(_what: str, _done: int, _total: int) -> None:
    """No progress is shown."""
