"""Lists of clips: filtered, sorted, page by page."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import ColumnElement, Select, exists, func, or_, select

from app.errors import BadField
from app.kinedex_error import Place
from app.store.clips import repository as clip_repository
from app.store.clips.filter import ClipFilter, condition, id_sets
from app.store.clips.measures import MEASURES, QUALITY
from app.store.clips.record import REANALYSIS_OPEN, ClipRecord, ClipState, Reanalysis
from app.store.database.blobs import to_blob
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, Value, after, read_cursor, write_cursor
from app.store.database.tables import clip_arrays, clip_measures, clip_metadata, clips
from app.store.database.totals import Total, total_of

DEFAULT_SORT = "-created_at"
FEW = 5000
"""Clips that are sorted in less time than it takes to walk through all clips in the order of a list
(100,000 clips, SQLite)."""


LEAST = -1e30
"""Stands for a measure that a clip lacks: less than any value."""


@dataclass(frozen=True, slots=True)
class _Sort:
    column: ColumnElement[Value]
    kind: type[Value]


def _of_quality(name: str) -> ColumnElement[Value]:
    """A measure of quality as a column of `clips`; some are negative."""
    found = select(clip_measures.c[name]).where(clip_measures.c.clip_id == clips.c.id)
    return func.coalesce(found.scalar_subquery(), LEAST)


# coalesce: databases sort NULL differently; so a clip without the value sorts before all others.
_SORTS: dict[str, _Sort] = {
    "created_at": _Sort(clips.c.created_at, datetime),
    "name": _Sort(clips.c.name_folded, str),
    **{name: _Sort(func.coalesce(clips.c[name], -1.0), float) for name in MEASURES},
    **{name: _Sort(_of_quality(name), float) for name in QUALITY},
    "person": _Sort(func.coalesce(clips.c.person, ""), str),
    "task": _Sort(func.coalesce(clips.c.task, ""), str),
}
SORT_NAMES: tuple[str, ...] = tuple(_SORTS)
"""The names by which a list can be sorted; a leading "-" reverses the order."""


def list_clips(
    tx: Tx,
    filter: ClipFilter,
    *,
    sort: str = DEFAULT_SORT,
    limit: int = 50,
    cursor: str | None = None,
) -> Page[ClipRecord]:
    """One page of at most `limit` clips; raises BadField at "sort", PageNotFound at "cursor"."""
    chosen, descending = _sort_of(sort)
    passes = condition(filter, _sought_id(tx, filter))
    query = select(clips, chosen.column.label("sorted_by")).where(passes)
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
    """The number of clips that pass the filter."""
    count = tx.execute(select(func.count()).select_from(clips).where(condition(filter)))
    return int(count.scalar_one())


def total(tx: Tx, filter: ClipFilter) -> Total:
    """How many clips pass the filter; an estimate if there are many."""
    return total_of(tx, select(clips.c.id).where(condition(filter)))


def list_ids(tx: Tx, filter: ClipFilter) -> tuple[str, ...]:
    """The ids of all clips that pass the filter."""
    return tuple(tx.execute(select(clips.c.id).where(condition(filter))).scalars())


def ids_by_path(tx: Tx, filter: ClipFilter) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The ids of all clips that pass the filter, sorted by path, and the keys of their metadata."""
    by_path = func.coalesce(clips.c.path, clips.c.file_name)
    query = select(clips.c.id).where(condition(filter)).order_by(by_path, clips.c.id)
    keys = (
        select(clip_metadata.c.key)
        .join(clips, clips.c.id == clip_metadata.c.clip_id)
        .where(condition(filter))
        .distinct()
        .order_by(clip_metadata.c.key)
    )
    return tuple(tx.execute(query).scalars()), tuple(tx.execute(keys).scalars())


def list_outdated_ids(tx: Tx, version: int) -> tuple[str, ...]:
    """The ids of ready clips that need another analysis and do not wait for one yet.

    Their arrays are from another version of the analysis than `version`, or a client changed the
    input of the analysis.
    """
    is_other = func.coalesce(clips.c.analysis_version, -1) != version
    return _ready_ids(tx, or_(is_other, clips.c.is_changed))


def list_ids_with_other_array(tx: Tx, name: str, expected: NDArray[Any]) -> tuple[str, ...]:
    """The ids of ready clips that do not have the array `expected` under this name.

    Clips that wait for another analysis are left out.
    """
    same = exists().where(
        clip_arrays.c.clip_id == clips.c.id,
        clip_arrays.c.name == name,
        clip_arrays.c.data == to_blob(expected)["data"],
    )
    return _ready_ids(tx, ~same)


def _ready_ids(tx: Tx, passes: ColumnElement[bool]) -> tuple[str, ...]:
    """The ids of the ready clips that pass and do not wait for another analysis, sorted."""
    query = select(clips.c.id).where(
        clips.c.state == ClipState.READY.value,
        passes,
        func.coalesce(clips.c.reanalysis, "").not_in(REANALYSIS_OPEN),
    )
    return tuple(tx.execute(query.order_by(clips.c.id)).scalars())


def list_unfit_ids(tx: Tx) -> tuple[str, ...]:
    """The ids of the clips whose last analysis failed, including clips that are still ready."""
    is_unfit = or_(
        clips.c.state == ClipState.FAILED.value, clips.c.reanalysis == Reanalysis.FAILED.value
    )
    return tuple(tx.execute(select(clips.c.id).where(is_unfit).order_by(clips.c.id)).scalars())


def count_waiting(tx: Tx) -> int:
    """The number of clips whose analysis is waiting or running."""
    return int(tx.execute(select(func.count()).select_from(clips).where(_WAITS)).scalar_one())


def is_being_analyzed_anew(tx: Tx, version: int) -> bool:
    """Whether any clip with arrays of another version than `version` is in an analysis or waits."""
    query = select(clips.c.id).where(_WAITS, clips.c.analysis_version != version)
    return tx.execute(query.limit(1)).first() is not None


_WAITS = or_(
    clips.c.state.in_((ClipState.QUEUED.value, ClipState.PROCESSING.value)),
    clips.c.reanalysis.in_(REANALYSIS_OPEN),
)


def _sought_id(tx: Tx, filter: ClipFilter) -> ColumnElement[str]:
    """The id of a clip, as the conditions of one page of a list look for it.

    SQLite begins with the ids that a condition finds, reads all of their clips, and sorts them. If
    a third of 100,000 clips has a value, this takes 115 ms. So with many ids, the column is hidden
    in an expression: then SQLite walks through the clips in their order until the page is full,
    which takes 18 ms.
    """
    sets = id_sets(filter)
    if sets and all(_is_large(tx, ids) for ids in sets):
        return func.coalesce(clips.c.id, "")
    return clips.c.id


def _is_large(tx: Tx, ids: Select[tuple[str]]) -> bool:
    counted = select(func.count()).select_from(ids.limit(FEW + 1).subquery())
    return int(tx.execute(counted).scalar_one()) > FEW


def _sort_of(sort: str) -> tuple[_Sort, bool]:
    name = sort.removeprefix("-")
    if name not in _SORTS:
        names = ", ".join(SORT_NAMES)
        raise BadField(places=[Place("sort", f"expected one of {names}, or one with a leading -")])
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
    items = tuple(clip_repository.to_records(tx, shown))
    if len(rows) <= limit or not shown:
        return Page(items, None)
    return Page(items, write_cursor(sort, Position(shown[-1]["sorted_by"], shown[-1]["id"])))
