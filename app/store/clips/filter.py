"""A filter of clips: one value for lists and for searches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import ColumnElement, Select, and_, or_, select

from app.store.clips.record import ClipState
from app.store.database.tables import clip_words, clips

_LABELS = ("person", "task", "license", "source")
"""Labels with a column of their own; for each, ClipFilter has two fields: NAME and not_NAME."""


@dataclass(frozen=True, slots=True)
class ClipFilter:
    """Conditions on clips. A clip passes if all of them hold.

    A tuple holds if the clip has any of its values; with not_, if it has none of them (a clip
    without the label passes). Empty or None is no condition. q: part of the name, any case;
    durations in seconds, both ends included.
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
        # autoescape: % and _ stand for themselves.
        terms.append(clips.c.name_folded.contains(filter.q.casefold(), autoescape=True))
    return and_(True, *terms)


def _label_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    for name in _LABELS:
        column = clips.c[name]
        if accepted := getattr(filter, name):
            yield column.in_(accepted)
        if refused := getattr(filter, f"not_{name}"):
            # NOT IN alone would drop the clips that have no such label.
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
