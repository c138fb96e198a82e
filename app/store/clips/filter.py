"""The filter of clips that lists and searches share."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, Select, String, and_, cast, false, func, or_, select

from app.store.clips import visibility
from app.store.clips.measures import MEASURES, QUALITY
from app.store.clips.record import ClipState
from app.store.database.collection_tables import collection_items
from app.store.database.engine import Tx
from app.store.database.tables import (
    clip_annotations,
    clip_measures,
    clip_metadata,
    clip_words,
    clips,
)

_LABELS = ("person", "task", "license", "source")
"""Labels that are columns of the table `clips`. ClipFilter has two fields for each: NAME and
not_NAME."""
MISSABLE = ("person", "task", "words")
"""Labels that a clip may lack."""


@dataclass(frozen=True, slots=True)
class MetadataCondition:
    """A condition on one key of the metadata. A clip without the key does not meet it.

    texts: the value must have one of these texts (`metadata_values.as_text`); none: any text;
    minimum, maximum: the value must be a number between them, both ends included; is_negated: a
    clip meets the condition if it does not meet it as it stands, so a clip without the key does.
    """

    key: str
    texts: tuple[str, ...] = ()
    minimum: float | None = None
    maximum: float | None = None
    is_negated: bool = False

    def accepts(self, text: str, number: float | None) -> bool:
        """Whether a value passes; text: of the value; number: None if it is none."""
        if self.texts and text not in self.texts:
            return False
        if self.minimum is not None and (number is None or number < self.minimum):
            return False
        return self.maximum is None or (number is not None and number <= self.maximum)


@dataclass(frozen=True, slots=True)
class MeasureBound:
    """The least and the largest value of one of `measures.EVERY`, both ends included."""

    name: str
    minimum: float | None = None
    maximum: float | None = None


@dataclass(frozen=True, slots=True)
class ClipFilter:
    """Conditions on clips. A clip passes the filter if all conditions are true.

    A tuple is true if the clip has any of its values. A tuple whose name begins with `not_` is
    true if the clip has none of its values; a clip without the label passes. An empty tuple and
    None are no condition. all_of, any_of, none_of: filters of which a clip passes all, any and
    none. ids: of clips; folder: the clip's file was in the folder or below it; collection: ids of
    collections that hold the clip or a part of it; annotation: words that an annotation of the clip
    has; members, annotated: the ids of the clips that meet these two conditions, which a search in
    memory needs (`services.library.filters`); created_after, created_before: when the clip came;
    missing: labels (`MISSABLE`) of which the clip lacks at least one; has_warnings: whether it has
    any; q: a part of the name, the path or a text of the metadata, in upper or lower case;
    min_NAME, max_NAME: of a measure (`measures.MEASURES`), both ends included; measured: bounds of
    any. A search knows none of state, missing, has_warnings and q.
    """

    all_of: tuple[ClipFilter, ...] = ()
    any_of: tuple[ClipFilter, ...] = ()
    none_of: tuple[ClipFilter, ...] = ()
    ids: tuple[str, ...] = ()
    annotation: tuple[str, ...] = ()
    annotated: tuple[str, ...] = ()
    created_after: datetime | None = None
    created_before: datetime | None = None
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
    folder: tuple[str, ...] = ()
    not_folder: tuple[str, ...] = ()
    collection: tuple[str, ...] = ()
    members: tuple[str, ...] = ()
    metadata: tuple[MetadataCondition, ...] = ()
    measured: tuple[MeasureBound, ...] = ()
    state: tuple[ClipState, ...] = ()
    missing: tuple[str, ...] = ()
    has_warnings: bool | None = None
    min_duration: float | None = None
    max_duration: float | None = None
    min_frame_rate: float | None = None
    max_frame_rate: float | None = None
    min_joints: float | None = None
    max_joints: float | None = None
    min_travel: float | None = None
    max_travel: float | None = None
    min_speed: float | None = None
    max_speed: float | None = None
    min_energy: float | None = None
    max_energy: float | None = None
    min_tempo: float | None = None
    max_tempo: float | None = None
    q: str | None = None

    @property
    def is_empty(self) -> bool:
        """Whether every clip passes."""
        return self == ClipFilter()

    def id_conditions(self) -> Iterator[tuple[bool, tuple[str, ...]]]:
        """For each condition that names clips: whether it is asked for, and their ids."""
        yield bool(self.ids), self.ids
        yield bool(self.collection), self.members
        yield bool(self.annotation), self.annotated

    def ranges(self) -> Iterator[tuple[str, float | None, float | None]]:
        """The measures with a condition, each with the least and the largest value."""
        for name in MEASURES:
            least, most = getattr(self, f"min_{name}"), getattr(self, f"max_{name}")
            if (least, most) != (None, None):
                yield name, least, most
        for bound in self.measured:
            yield bound.name, bound.minimum, bound.maximum


def condition(filter: ClipFilter, clip_id: ColumnElement[str] = clips.c.id) -> ColumnElement[bool]:
    """The filter as a WHERE clause over `clips`; clips that are not visible do not pass.

    clip_id: `clips.c.id`, or an expression of the same value: the ids of `id_sets` contain it.
    """
    return and_(visibility.is_visible(), _passes(filter, clip_id))


def _passes(filter: ClipFilter, clip_id: ColumnElement[str] = clips.c.id) -> ColumnElement[bool]:
    """The filter without what is visible; NULL counts as false."""
    terms = [*_label_terms(filter), *_range_terms(filter), *map(clip_id.in_, id_sets(filter))]
    terms += [*_date_terms(filter), *_tree_terms(filter)]
    if filter.ids:
        terms.append(clips.c.id.in_(filter.ids))
    if filter.state:
        terms.append(clips.c.state.in_([state.value for state in filter.state]))
    if filter.not_word:
        terms.append(clips.c.id.not_in(_carriers(filter.not_word)))
    terms.extend(_lack_terms(filter))
    if filter.q:
        # autoescape: % and _ in `q` are plain characters, not wildcards.
        terms.append(clips.c.searched.contains(filter.q.casefold(), autoescape=True))
    refused = (_holders(one) for one in filter.metadata if one.is_negated)
    terms.extend(map(clips.c.id.not_in, refused))
    return and_(True, *terms, *_folder_terms(filter))


def _tree_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    """The conditions of the filters below this one."""
    yield from map(_passes, filter.all_of)
    if filter.any_of:
        yield or_(*map(_passes, filter.any_of))
    for one in filter.none_of:
        # A comparison with NULL is NULL, and so is its opposite.
        yield ~func.coalesce(_passes(one), false())


def _date_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    if filter.created_after is not None:
        yield clips.c.created_at >= filter.created_after
    if filter.created_before is not None:
        yield clips.c.created_at < filter.created_before


def id_sets(filter: ClipFilter) -> list[Select[tuple[str]]]:
    """The ids of the clips that meet one condition, for each condition on a table beside `clips`.

    Conditions that refuse clips are left out.
    """
    accepted = [_holders(one) for one in filter.metadata if not one.is_negated]
    if filter.collection:
        accepted.append(_collected(filter.collection))
    if filter.annotation:
        accepted.append(_annotated(filter.annotation))
    return [*accepted, _carriers(filter.word)] if filter.word else accepted


def _collected(collection_ids: tuple[str, ...]) -> Select[tuple[str]]:
    """Ids of the clips that are in any of the collections."""
    column = collection_items.c
    return select(column.clip_id).where(column.collection_id.in_(collection_ids))


def annotated_ids(tx: Tx, words: tuple[str, ...]) -> tuple[str, ...]:
    """Ids of the clips with an annotation that has any of `words`, each once."""
    query = select(clip_annotations.c.clip_id).where(_has_word(words)).distinct()
    return tuple(tx.execute(query).scalars())


def _annotated(words: tuple[str, ...]) -> Select[tuple[str]]:
    """Ids of the clips with an annotation that has any of `words`."""
    return select(clip_annotations.c.clip_id).where(_has_word(words))


def _has_word(words: tuple[str, ...]) -> ColumnElement[bool]:
    """The condition for annotations that have any of `words`."""
    texts = cast(clip_annotations.c.words, String)
    # The column holds a JSON array of texts; a database may keep letters escaped or not.
    forms = {json.dumps(word, ensure_ascii=plain) for word in words for plain in (True, False)}
    return or_(*(texts.contains(form, autoescape=True) for form in sorted(forms)))


def _lack_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    if filter.missing:
        lacks = {
            "person": clips.c.person.is_(None),
            "task": clips.c.task.is_(None),
            "words": clips.c.id.not_in(select(clip_words.c.clip_id)),
        }
        yield or_(*(lacks[name] for name in filter.missing))
    if filter.has_warnings is not None:
        has_none = func.coalesce(cast(clips.c.warnings, String), "null").in_(("[]", "null"))
        yield ~has_none if filter.has_warnings else has_none


def is_in_folder(folder: str, parent: str) -> bool:
    """Whether a folder is `parent` or below it."""
    return folder == parent or folder.startswith(f"{parent}/")


def _folder_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    if filter.folder:
        yield or_(*map(in_folder, filter.folder))
    if filter.not_folder:
        # a clip without a path is in no folder
        yield or_(clips.c.folder.is_(None), ~or_(*map(in_folder, filter.not_folder)))


def in_folder(parent: str) -> ColumnElement[bool]:
    """The condition for clips in a folder or below it; compare `is_in_folder`."""
    # Not LIKE, which takes no account of upper and lower case in SQLite.
    begins = func.substr(clips.c.folder, 1, len(parent) + 1) == f"{parent}/"
    return or_(clips.c.folder == parent, begins)


def _holders(condition: MetadataCondition) -> Select[tuple[str]]:
    """Ids of the clips with a value that a condition describes, negated or not."""
    column = clip_metadata.c
    terms = [column.key == condition.key]
    if condition.texts:
        terms.append(column.text.in_(condition.texts))
    if condition.minimum is not None:
        terms.append(column.number >= condition.minimum)
    if condition.maximum is not None:
        terms.append(column.number <= condition.maximum)
    return select(column.clip_id).where(*terms)


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


def _range_terms(filter: ClipFilter) -> Iterator[ColumnElement[bool]]:
    for name, least, most in filter.ranges():
        if name in QUALITY:
            yield clips.c.id.in_(_measured(name, least, most))
            continue
        if least is not None:
            yield clips.c[name] >= least
        if most is not None:
            yield clips.c[name] <= most


def _measured(name: str, least: float | None, most: float | None) -> Select[tuple[str]]:
    """Ids of the clips with a measure of quality between two bounds."""
    column = clip_measures.c[name]
    query = select(clip_measures.c.clip_id).where(column.is_not(None))
    if least is not None:
        query = query.where(column >= least)
    return query if most is None else query.where(column <= most)
