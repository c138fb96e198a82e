"""Pairs of clips that are near-duplicates, and which clips have been compared with all others."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, and_, delete, func, insert, or_, select, update

from app.store.clips import versions as library
from app.store.clips.record import ClipState
from app.store.clips.repository import in_batches
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import clips, duplicate_checks, duplicate_pairs


@dataclass(frozen=True, slots=True)
class DuplicatePair:
    """Two clips, the smaller id first, and the evidence.

    kind: see `app.search.duplicates.kinds`. distance: of the movements, 0 for the same. offset:
    body lengths between the mean poses. shift: seconds of the first clip at which the second one
    begins. seconds: the length of the overlap. is_mirrored: whether left and right are exchanged.
    dismissed_at: when a person said that the pair is none, else None.
    """

    clip_id: str
    other_id: str
    kind: str
    distance: float
    offset: float
    shift: float
    seconds: float
    is_mirrored: bool
    dismissed_at: datetime | None = None

    @property
    def ids(self) -> tuple[str, str]:
        """Both ids."""
        return self.clip_id, self.other_id


_COLUMNS = tuple(duplicate_pairs.c)
_PENDING = and_(
    clips.c.state == ClipState.READY.value,
    func.coalesce(duplicate_checks.c.version, -1) != clips.c.changed_version,
)
_JOINED = clips.outerjoin(duplicate_checks, duplicate_checks.c.clip_id == clips.c.id)


def pending(tx: Tx, limit: int) -> dict[str, int]:
    """Ready clips that changed since they were compared, the oldest first, with their versions."""
    query = select(clips.c.id, clips.c.changed_version).select_from(_JOINED).where(_PENDING)
    rows = tx.execute(query.order_by(clips.c.changed_version, clips.c.id).limit(limit))
    return {row.id: row.changed_version for row in rows}


def count_pending(tx: Tx) -> int:
    """The number of ready clips that still have to be compared with the others."""
    query = select(func.count()).select_from(_JOINED).where(_PENDING)
    return int(tx.execute(query).scalar_one())


def partners(tx: Tx, clip_ids: Collection[str]) -> set[tuple[str, str]]:
    """The ids of all stored pairs of these clips."""
    found: set[tuple[str, str]] = set()
    for batch in in_batches(clip_ids):
        query = select(duplicate_pairs.c.clip_id, duplicate_pairs.c.other_id)
        rows = tx.execute(query.where(_has_any(batch)))
        found.update((row.clip_id, row.other_id) for row in rows)
    return found


def put(tx: Tx, versions: Mapping[str, int], pairs: Iterable[DuplicatePair]) -> None:
    """Store the pairs of clips that were compared; they replace all earlier pairs of these clips.

    versions: of the compared clips. A pair that was dismissed stays so. Clips that were deleted
    meanwhile are left out.
    """
    library.lock(tx)  # several workers may have compared the same clips
    existing = _existing(tx, {*versions, *(i for pair in pairs for i in pair.ids)})
    dismissed: dict[tuple[str, str], datetime] = {}
    for batch in in_batches(versions):
        for row in tx.execute(select(*_COLUMNS).where(_has_any(batch))).mappings():
            if row["dismissed_at"] is not None:
                dismissed[row["clip_id"], row["other_id"]] = row["dismissed_at"]
        tx.execute(delete(duplicate_pairs).where(_has_any(batch)))
        tx.execute(delete(duplicate_checks).where(duplicate_checks.c.clip_id.in_(batch)))
    rows = [
        {**asdict(pair), "dismissed_at": dismissed.get(pair.ids)}
        for pair in pairs
        if existing.issuperset(pair.ids)
    ]
    if rows:
        tx.execute(insert(duplicate_pairs), rows)
    checks = [{"clip_id": i, "version": v} for i, v in versions.items() if i in existing]
    if checks:
        tx.execute(insert(duplicate_checks), checks)


def open_pairs(
    tx: Tx, similar: str, threshold: float, limit: int | None = None
) -> list[DuplicatePair]:
    """The pairs that nobody dismissed: of one take, and of kind `similar` within a distance."""
    column = duplicate_pairs.c
    is_shown = or_(column.kind != similar, column.distance <= threshold)
    query = select(*_COLUMNS).where(column.dismissed_at.is_(None), is_shown)
    ordered = query.order_by(column.clip_id, column.other_id).limit(limit)
    rows = tx.execute(ordered).mappings()
    return [DuplicatePair(**row) for row in rows]


def dismiss(tx: Tx, pairs: Sequence[DuplicatePair]) -> None:
    """No list shows these pairs again."""
    column = duplicate_pairs.c
    for pair in pairs:
        chosen = and_(column.clip_id == pair.clip_id, column.other_id == pair.other_id)
        tx.execute(update(duplicate_pairs).where(chosen).values(dismissed_at=utc_now()))


def _existing(tx: Tx, clip_ids: Collection[str]) -> set[str]:
    found: set[str] = set()
    for batch in in_batches(clip_ids):
        found.update(tx.execute(select(clips.c.id).where(clips.c.id.in_(batch))).scalars())
    return found


def _has_any(clip_ids: Collection[str]) -> ColumnElement[bool]:
    column = duplicate_pairs.c
    return or_(column.clip_id.in_(clip_ids), column.other_id.in_(clip_ids))
