"""The filter of clips that lists and searches share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import ColumnElement, Select, and_, or_, select

from app.store.clips.record import ClipState
from app.store.database.tables import clip_words, clips

_LABELS = ("person", "task", "license", "source")
"""Labels that are columns of the table `clips`. ClipFilter has two fields for each: NAME and
not_NAME."""


@dataclass(frozen=True, slots=True)
class ClipFilter:
    """Conditions on clips. A clip passes the filter if all conditions are true.

    A tuple is true if the clip has any of its values. A tuple whose name begins with `not_` is
    true if the clip has none of its values; a clip without the label passes. An empty tuple and
    None are no condition. q: a part of the name, in upper or lower case; min_duration,
    max_duration: seconds, both ends included.
    """

    person: tuple[str, ...] = ()
    task: tuple[str, ...] = ()
    word: tuple[str, ...] = ()
    license: tuple[str, ...] = ()
    source: tuple[str, ...] = ()
    not_person: tuple[str, ...] = ()
    not_task: tuple[str, ...] = ()
    not_word: tuple[str, ...] = ()
    not_license: tuple[str, ...] = ()
    not_source: tuple[str, ...] = ()
    state: tuple[ClipState, ...] = ()
    min_duration: float | None = None
    max_duration: float | None = None
    q: str | None = None

    @property
    def is_empty(self) -> bool:
        """Whether every clip passes."""
        return self == ClipFilter()


def condition(filter: ClipFilter) -> ColumnElement[bool]:
    """The filter as a WHERE clause over `clips`."""
    terms = [*_label_terms(filter), *_range_terms(filter)]
    if filter.state:
        terms.append(clips.c.state.in_([state.value for state in filter.state]))
    if filter.word:
        terms.append(clips.c.id.in_(_carriers(filter.word)))
    if filter.not_word:
        terms.append(clips.c.id.not_in(_carriers(filter.not_word)))
    if filter.q:
        # autoescape: % and _ in `q` are plain characters, not wildcards.
        terms.append(clips.c.name_folded.contains(filter.q.casefold(), autoescape=True))
    return and_(True, *terms)


def _label_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    for name in _LABELS:
        column = clips.c[name]
        if accepted := getattr(filter, name):
            yield column.in_(accepted)
        if refused := getattr(filter, f"not_{name}"):
            # NULL NOT IN (...) is NULL, so NOT IN alone would drop clips without the label.
            yield or_(column.is_(None), column.not_in(refused))


def _carriers(words: tuple[str, ...]) -> Select[tuple[str]]:
    """Ids of the clips that carry any of `words`."""
    return select(clip_words.c.clip_id).where(clip_words.c.word.in_(words))


def _range_terms(filter: ClipFilter) -> list[ColumnElement[bool]]:
    terms: list[ColumnElement[bool]] = []
    if filter.min_duration is not None:
        terms.append(clips.c.duration >= filter.min_duration)
    if filter.max_duration is not None:
        terms.append(clips.c.duration <= filter.max_duration)
    return terms
