"""Near-duplicates as groups, each with a proposed keeper."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from app.errors import NotFound
from app.kinedex_error import Place
from app.search.duplicates.kinds import PairKind
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord
from app.store.curation import pairs as stored
from app.store.curation.pairs import DuplicatePair
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, read_cursor, write_cursor
from app.store.database.totals import Total

PREFIX, CLIP_PREFIX = "dup_", "clip_"
_SORT = "group"


@dataclass(frozen=True, slots=True)
class DuplicateGroup:
    """Clips that are connected by pairs.

    id: made from the smallest id of its clips. keeper: the clip to keep. clips: the keeper first.
    pairs: the evidence.
    """

    id: str
    keeper: str
    clips: tuple[ClipRecord, ...]
    pairs: tuple[DuplicatePair, ...]


@dataclass(frozen=True, slots=True)
class Duplicates:
    """A page of groups, and the number of clips that were not compared yet."""

    page: Page[DuplicateGroup]
    pending: int


def list_groups(
    lib: Library,
    *,
    threshold: float = 0.0,
    kind: PairKind | None = None,
    limit: int = 10,
    cursor: str | None = None,
) -> Duplicates:
    """One page of the groups, the largest first.

    threshold: the largest distance of pairs that are not of one take. kind: only pairs of this
    kind. Raises PageNotFound for a bad cursor.
    """
    with lib.store.read() as tx:
        pairs = stored.open_pairs(tx, PairKind.SIMILAR, threshold)
        pending = stored.count_pending(tx)
        if kind is not None:
            pairs = [pair for pair in pairs if pair.kind == kind]
        groups = sorted(_connected(pairs), key=lambda ids: (-len(ids), ids[0]))
        rest = groups
        if cursor is not None:
            position = read_cursor(cursor, _SORT, float)
            rest = [ids for ids in groups if (-len(ids), ids[0]) > (position.value, position.id)]
        shown = rest[:limit]
        records = clips.get_many(tx, [clip_id for ids in shown for clip_id in ids])
    next_cursor = None
    if len(rest) > limit:
        next_cursor = write_cursor(_SORT, Position(float(-len(shown[-1])), shown[-1][0]))
    items = tuple(_group(ids, records, _pairs_of(ids, pairs)) for ids in shown)
    page = Page(items, next_cursor).counted(Total(len(groups), is_exact=True))
    return Duplicates(page, pending)


def duplicate_groups(tx: Tx) -> dict[str, tuple[str, ...]]:
    """The ids of the clips of each group of near-duplicates, by the id of the group."""
    pairs = stored.open_pairs(tx, PairKind.SIMILAR, 0.0)
    return {PREFIX + ids[0].removeprefix(CLIP_PREFIX): ids for ids in sorted(_connected(pairs))}


def example_id(tx: Tx) -> str | None:
    """The id of a group, None without one."""
    pairs = stored.open_pairs(tx, PairKind.SIMILAR, 0.0, limit=1)
    # the first pair has the smallest id of all, which names its group
    return PREFIX + pairs[0].clip_id.removeprefix(CLIP_PREFIX) if pairs else None


def dismiss(lib: Library, group_id: str, *, threshold: float = 0.0) -> None:
    """The pairs of a group are no duplicates: no list shows them again.

    threshold: as in the list that showed the group. Raises NotFound.
    """
    first = CLIP_PREFIX + group_id.removeprefix(PREFIX)
    with lib.store.write() as tx:
        pairs = stored.open_pairs(tx, PairKind.SIMILAR, threshold)
        chosen = next((ids for ids in _connected(pairs) if ids[0] == first), None)
        if chosen is None or not group_id.startswith(PREFIX):
            places = [Place("group_id", "is the id of no group")]
            raise NotFound(f"There is no group with the id {group_id!r}", places=places)
        stored.dismiss(tx, _pairs_of(chosen, pairs))


def _connected(pairs: Iterable[DuplicatePair]) -> list[tuple[str, ...]]:
    """The sorted ids of each group of clips that pairs connect."""
    leader: dict[str, str] = {}

    def find(clip_id: str) -> str:
        while leader.setdefault(clip_id, clip_id) != clip_id:
            leader[clip_id] = leader[leader[clip_id]]
            clip_id = leader[clip_id]
        return clip_id

    for pair in pairs:
        leader[find(pair.other_id)] = find(pair.clip_id)
    members: dict[str, list[str]] = defaultdict(list)
    for clip_id in list(leader):
        members[find(clip_id)].append(clip_id)
    return [tuple(sorted(ids)) for ids in members.values()]


def _pairs_of(ids: Sequence[str], pairs: Iterable[DuplicatePair]) -> list[DuplicatePair]:
    inside = set(ids)
    return [pair for pair in pairs if pair.clip_id in inside]


def _group(
    ids: Sequence[str], records: Mapping[str, ClipRecord], pairs: Sequence[DuplicatePair]
) -> DuplicateGroup:
    found = sorted((records[i] for i in ids if i in records), key=_preference, reverse=True)
    name = PREFIX + ids[0].removeprefix(CLIP_PREFIX)
    return DuplicateGroup(name, found[0].id, tuple(found), tuple(pairs))


def _preference(clip: ClipRecord) -> tuple[float, int, float, int, float, str]:
    """The keeper is the longest clip, then that with most joints, the highest frame rate, most
    labels, then the oldest."""
    labels = sum(value is not None for value in (clip.person, clip.task, clip.license, clip.source))
    return (
        round(clip.duration or 0.0, 1),
        clip.joints or 0,
        round(clip.frame_rate or 0.0, 1),
        labels + len(clip.words),
        -clip.created_at.timestamp(),
        clip.id,
    )
