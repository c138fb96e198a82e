"""Verifies a library: its database, all files that it names, and all arrays in it."""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass

from sqlalchemy import select

from app.errors import BadField, DatabaseDamaged, FileDamaged, NotFound
from app.store.clips.record import ClipState
from app.store.database.blobs import from_blob_if_whole
from app.store.database.tables import clip_arrays, clips, model_arrays
from app.store.files.quarantine import QuarantineContent
from app.store.jobs import references
from app.store.store import Store

ROWS_AT_ONCE = 50
"""Arrays that are in memory at the same time."""

Progress = Callable[[int, int], None]
"""Called with the number of hashed files and the number of all files."""


@dataclass(frozen=True, slots=True)
class VerificationReport:
    """The result of a verification.

    files, arrays: the number of those that were read; damage: of the database, one sentence for
    each finding; unreadable: arrays, as `<id of clip or model>/<name>`; lacking: the same for
    arrays that a ready clip must have and does not; missing, damaged: names of files; unknown:
    files that the database does not name, and which the next sweep moves to the quarantine;
    quarantine: the files that are there already. The last two are no damage.
    """

    files: int
    arrays: int
    damage: tuple[str, ...]
    unreadable: tuple[str, ...]
    lacking: tuple[str, ...]
    missing: tuple[str, ...]
    damaged: tuple[str, ...]
    unknown: tuple[str, ...]
    quarantine: QuarantineContent

    @property
    def is_whole(self) -> bool:
        """Whether the library has no damage."""
        arrays = self.unreadable or self.lacking
        return not (self.damage or arrays or self.missing or self.damaged)


def verify(
    store: Store, progress: Progress | None = None, *, needed_arrays: Collection[str] = ()
) -> VerificationReport:
    """Reads the whole library, while others use it. Raises StorageError.

    needed_arrays: names of the arrays that every ready clip must have.
    """
    damage = list(store.database.find_damage())
    try:
        with store.read() as tx:
            needed = references.referenced(tx)
    except DatabaseDamaged as problem:
        damage.append(
            f"the files were not checked, because their names cannot be read: {problem.detail}"
        )
        needed = frozenset()
    # A damaged database may have lost the names of files.
    unknown = () if damage else tuple(sorted(set(store.files) - needed))
    arrays, unreadable = _read_arrays(store)
    missing, damaged = _hash_all(store, needed, progress)
    return VerificationReport(
        files=len(needed),
        arrays=arrays,
        damage=tuple(damage),
        unreadable=unreadable,
        lacking=_lacking(store, needed_arrays),
        missing=missing,
        damaged=damaged,
        unknown=unknown,
        quarantine=store.files.quarantine.content(),
    )


def _hash_all(
    store: Store, names: frozenset[str], progress: Progress | None
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of missing files, and of files that are damaged or cannot be read."""
    missing, damaged = [], []
    for done, sha256 in enumerate(sorted(names), 1):
        try:
            store.files.check(sha256)
        except NotFound:
            missing.append(sha256)
        except (FileDamaged, BadField):  # BadField: a name that is no SHA-256
            damaged.append(sha256)
        if progress is not None:
            progress(done, len(names))
    return _still_needed(store, missing), tuple(damaged)


def _still_needed(store: Store, missing: list[str]) -> tuple[str, ...]:
    """The missing files without those whose clips were deleted meanwhile."""
    if not missing:
        return ()
    with store.read() as tx:
        needed = references.referenced(tx)
    return tuple(sha256 for sha256 in missing if sha256 in needed)


def _read_arrays(store: Store) -> tuple[int, tuple[str, ...]]:
    """The number of all arrays, and the names of those that cannot be read."""
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
                    if from_blob_if_whole(*row[2:]) is None:
                        unreadable.append(f"{row[0]}/{row[1]}")
        except DatabaseDamaged:
            unreadable.append(f"{table.name}: not all rows can be read")
    return count, tuple(unreadable)


def _lacking(store: Store, names: Collection[str]) -> tuple[str, ...]:
    """The needed arrays that ready clips do not have. A damaged table was reported before."""
    found: list[str] = []
    for name in names:
        has_it = select(clip_arrays.c.clip_id).where(
            clip_arrays.c.clip_id == clips.c.id, clip_arrays.c.name == name
        )
        without = select(clips.c.id).where(clips.c.state == ClipState.READY.value, ~has_it.exists())
        with suppress(DatabaseDamaged), store.read() as tx:
            found += [f"{clip_id}/{name}" for clip_id in tx.execute(without).scalars()]
    return tuple(sorted(found))
