"""Whether a library is whole: its database, every file that it names, every array in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sqlalchemy import select

from app.errors import DatabaseDamaged, FileDamaged, NotFound
from app.store.database.blobs import from_blob
from app.store.database.tables import clip_arrays, model_arrays
from app.store.files.hash_check import HashChecker
from app.store.files.quarantine import QuarantineContent
from app.store.jobs import references
from app.store.store import Store

ROWS_AT_ONCE = 50
"""Arrays in memory."""

Progress = Callable[[int, int], None]
"""Is told how many files were hashed, of how many."""


@dataclass(frozen=True, slots=True)
class VerificationReport:
    """What was looked at and what is wrong.

    damage: of the database, a sentence each; unreadable: arrays, as `<id of clip or model>/<name>`;
    missing, damaged: names of files; unknown: files that the database does not name, and which
    the next sweep moves to the quarantine; quarantine: what is there already. Neither of these
    two is wrong in itself.
    """

    files: int
    arrays: int
    damage: tuple[str, ...]
    unreadable: tuple[str, ...]
    missing: tuple[str, ...]
    damaged: tuple[str, ...]
    unknown: tuple[str, ...]
    quarantine: QuarantineContent

    @property
    def is_whole(self) -> bool:
        """Whether nothing is wrong."""
        return not (self.damage or self.unreadable or self.missing or self.damaged)


def verify(store: Store, progress: Progress | None = None) -> VerificationReport:
    """Reads everything, while others use the library. Raises StorageError."""
    damage = list(store.database.find_damage())
    try:
        with store.read() as tx:
            needed = references.referenced(tx)
    except DatabaseDamaged as problem:
        damage.append(f"no file was looked at, since their names cannot be read: {problem.detail}")
        needed = frozenset()
    unknown = () if damage else tuple(sorted(set(store.files) - needed))
    arrays, unreadable = _read_arrays(store)
    missing, damaged = _hash_all(store, needed, progress)
    return VerificationReport(
        files=len(needed),
        arrays=arrays,
        damage=tuple(damage),
        unreadable=unreadable,
        missing=missing,
        damaged=damaged,
        unknown=unknown,
        quarantine=store.files.quarantine.content(),
    )


def _hash_all(
    store: Store, names: frozenset[str], progress: Progress | None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The files that are missing, and those that are damaged or cannot be read."""
    checked = HashChecker()
    missing, damaged = [], []
    for done, sha256 in enumerate(sorted(names), 1):
        try:
            checked.check(store.files.path(sha256))
        except (NotFound, FileNotFoundError):
            missing.append(sha256)
        except (FileDamaged, OSError):
            damaged.append(sha256)
        if progress is not None:
            progress(done, len(names))
    return _still_needed(store, missing), tuple(damaged)


def _still_needed(store: Store, missing: list[str]) -> tuple[str, ...]:
    """Without those whose clips were deleted meanwhile."""
    if not missing:
        return ()
    with store.read() as tx:
        needed = references.referenced(tx)
    return tuple(sha256 for sha256 in missing if sha256 in needed)


def _read_arrays(store: Store) -> tuple[int, tuple[str, ...]]:
    """How many arrays there are, and which of them cannot be read."""
    count, unreadable = 0, []
    for table, key in (
        (clip_arrays, clip_arrays.c.clip_id),
        (model_arrays, model_arrays.c.model_id),
    ):
        query = select(key, table.c.name, table.c.dtype, table.c.shape, table.c.data)
        try:
            with store.read() as tx:
                for row in tx.execution_options(yield_per=ROWS_AT_ONCE).execute(query):
                    count += 1
                    if not _is_readable(*row[2:]):
                        unreadable.append(f"{row[0]}/{row[1]}")
        except DatabaseDamaged:
            unreadable.append(f"{table.name}: not all rows can be read")
    return count, tuple(unreadable)


def _is_readable(dtype: str, shape: str, data: bytes) -> bool:
    try:
        from_blob(dtype, shape, data)
    except (TypeError, ValueError):
        return False
    return True
