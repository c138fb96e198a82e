"""Which clips are meant: one value for lists and for searches."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import ColumnElement, Select, and_, or_, select

from app.store.clips.record import ClipState
from app.store.database.tables import clip_words, clips


@dataclass(frozen=True, slots=True)
class ClipFilter:
    """Every condition that is given must hold; a tuple means any of; empty or None: no condition.

    not_*: none of these; a clip that lacks the label passes. q: part of the name, any case;
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


def condition(wanted: ClipFilter) -> ColumnElement[bool]:
    """The filter as a WHERE clause over `clips`."""
    terms = [*_any_of_terms(wanted), *_none_of_terms(wanted), *_range_terms(wanted)]
    if wanted.word:
        terms.append(clips.c.id.in_(_carriers(wanted.word)))
    if wanted.not_word:
        terms.append(clips.c.id.not_in(_carriers(wanted.not_word)))
    if wanted.q:
        # autoescape: % and _ are looked for as themselves.
        terms.append(clips.c.name_folded.contains(wanted.q.casefold(), autoescape=True))
    return and_(True, *terms)


def _any_of_terms(wanted: ClipFilter) -> list[ColumnElement[bool]]:
    choices: dict[str, tuple[str, ...]] = {
        "person": wanted.person,
        "task": wanted.task,
        "license": wanted.license,
        "source": wanted.source,
        "state": tuple(state.value for state in wanted.state),
    }
    return [clips.c[name].in_(values) for name, values in choices.items() if values]


def _none_of_terms(wanted: ClipFilter) -> list[ColumnElement[bool]]:
    refused: dict[str, tuple[str, ...]] = {
        "person": wanted.not_person,
        "task": wanted.not_task,
        "license": wanted.not_license,
        "source": wanted.not_source,
    }
    # NOT IN alone would drop the clips that have no such label.
    return [
        or_(clips.c[name].is_(None), clips.c[name].not_in(values))
        for name, values in refused.items()
        if values
    ]


def _carriers(words: tuple[str, ...]) -> Select[tuple[str]]:
    """Ids of the clips that carry any of `words`."""
    return select(clip_words.c.clip_id).where(clip_words.c.word.in_(words))


def _range_terms(wanted: ClipFilter) -> list[ColumnElement[bool]]:
    terms: list[ColumnElement[bool]] = []
    if wanted.min_duration is not None:
        terms.append(clips.c.duration >= wanted.min_duration)
    if wanted.max_duration is not None:
        terms.append(clips.c.duration <= wanted.max_duration)
    return terms
