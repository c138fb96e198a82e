"""Lists of clips: filtered, sorted, page by page."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, Select, func, or_, select

from app.errors import BadField, Place
from app.store.clips import repository as clip_repository
from app.store.clips.filter import ClipFilter, condition
from app.store.clips.record import REANALYSIS_OPEN, ClipRecord, ClipState, Reanalysis
from app.store.clips.rows import to_record
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, Value, after, read_cursor, write_cursor
from app.store.database.tables import clips
from app.store.database.totals import Total, total_of

DEFAULT_SORT = "-created_at"


@dataclass(frozen=True, slots=True)
class _Sort:
    column: ColumnElement[Value]
    kind: type[Value]


# coalesce: a clip without the value sorts before all others, on every database.
_SORTS: dict[str, _Sort] = {
    "created_at": _Sort(clips.c.created_at, datetime),
    "name": _Sort(clips.c.name_folded, str),
    "duration": _Sort(func.coalesce(clips.c.duration, -1.0), float),
    "person": _Sort(func.coalesce(clips.c.person, ""), str),
    "task": _Sort(func.coalesce(clips.c.task, ""), str),
}
SORT_NAMES: tuple[str, ...] = tuple(_SORTS)
"""What a list can be sorted by; a leading "-" turns the order round."""


def list_clips(
    tx: Tx,
    filter: ClipFilter,
    *,
    sort: str = DEFAULT_SORT,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ClipRecord]:
    """One page of at most `limit` clips; raises BadField at "sort" or "cursor"."""
    chosen, descending = _sort_of(sort)
    query = select(clips, chosen.column.label("sorted_by")).where(condition(filter))
    if cursor is not None:
        position = read_cursor(cursor, sort, chosen.kind)
        query = query.where(after(chosen.column, clips.c.id, position, descending=descending))
    return _page(tx, _ordered(query, chosen, descending).limit(limit + 1), sort, limit)


def newest_ready(
    tx: Tx, *, is_labeled: bool = False, is_audible: bool = False
) -> ClipRecord | None:
    """The newest ready clip; with person and task, or with a recording, if asked for."""
    query = select(clips.c.id).where(clips.c.state == ClipState.READY.value)
    if is_labeled:
        query = query.where(clips.c.person.is_not(None), clips.c.task.is_not(None))
    if is_audible:
        query = query.where(clips.c.audio_sha256.is_not(None))
    newest = query.order_by(clips.c.created_at.desc(), clips.c.id.desc()).limit(1)
    clip_id = tx.execute(newest).scalar_one_or_none()
    return None if clip_id is None else clip_repository.get(tx, clip_id)


def count_clips(tx: Tx, filter: ClipFilter) -> int:
    """How many clips pass the filter."""
    found = tx.execute(select(func.count()).select_from(clips).where(condition(filter)))
    return int(found.scalar_one())


def total(tx: Tx, filter: ClipFilter) -> Total:
    """How many clips pass the filter; an estimate if there are many."""
    return total_of(tx, select(clips.c.id).where(condition(filter)))


def list_ids(tx: Tx, filter: ClipFilter) -> tuple[str, ...]:
    """The ids of all clips that pass the filter."""
    return tuple(tx.execute(select(clips.c.id).where(condition(filter))).scalars())


def list_outdated_ids(tx: Tx, version: int) -> tuple[str, ...]:
    """The ids of ready clips that need another analysis and do not wait for one yet.

    Their arrays are not those of analysis `version`, or a client changed what it depends on.
    """
    is_other = func.coalesce(clips.c.analysis_version, -1) != version
    query = select(clips.c.id).where(
        clips.c.state == ClipState.READY.value,
        or_(is_other, clips.c.is_changed),
        func.coalesce(clips.c.reanalysis, "").not_in(REANALYSIS_OPEN),
    )
    return tuple(tx.execute(query.order_by(clips.c.id)).scalars())


def list_unfit_ids(tx: Tx) -> tuple[str, ...]:
    """The ids of the clips whose last analysis failed, also of those that were ready before."""
    is_unfit = or_(
        clips.c.state == ClipState.FAILED.value, clips.c.reanalysis == Reanalysis.FAILED.value
    )
    return tuple(tx.execute(select(clips.c.id).where(is_unfit).order_by(clips.c.id)).scalars())


def count_waiting(tx: Tx) -> int:
    """How many clips wait for an analysis or are in one."""
    return int(tx.execute(select(func.count()).select_from(clips).where(_WAITS)).scalar_one())


def is_being_analyzed_anew(tx: Tx, version: int) -> bool:
    """Whether a clip that another analysis than `version` described waits for it, or is at it."""
    query = select(clips.c.id).where(_WAITS, clips.c.analysis_version != version)
    return tx.execute(query.limit(1)).first() is not None


_WAITS = or_(
    clips.c.state.in_((ClipState.QUEUED.value, ClipState.PROCESSING.value)),
    clips.c.reanalysis.in_(REANALYSIS_OPEN),
)


def _sort_of(sort: str) -> tuple[_Sort, bool]:
    name = sort.removeprefix("-")
    if name not in _SORTS:
        known = ", ".join(SORT_NAMES)
        raise BadField(places=[Place("sort", f"expected one of {known}, or one with a leading -")])
    return _SORTS[name], sort != name


def _ordered(
    query: Select[tuple[object, ...]], chosen: _Sort, descending: bool
) -> Select[tuple[object, ...]]:
    if descending:
        return query.order_by(chosen.column.desc(), clips.c.id.desc())
    return query.order_by(chosen.column, clips.c.id)


def _page(tx: Tx, query: Select[tuple[object, ...]], sort: str, limit: int) -> Page[ClipRecord]:
    rows = tx.execute(query).mappings().all()
    shown = rows[:limit]
    words = clip_repository.words_of(tx, [row["id"] for row in shown])
    items = tuple(to_record(row, words.get(row["id"], ())) for row in shown)
    if len(rows) <= limit or not shown:
        return Page(items, None)
    return Page(items, write_cursor(sort, Position(shown[-1]["sorted_by"], shown[-1]["id"])))
