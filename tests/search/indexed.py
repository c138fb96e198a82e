"""Generated clips for an index, and a filter that checks one clip at a time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hypothesis import strategies as st

from app.store.clips.filter import ClipFilter, MetadataCondition
from app.store.clips.index_feed import IndexedClip
from app.store.clips.measures import FOUND, MEASURES

PERSONS = ("ada", "bruno", "chika", None)
TASKS = ("walk", "run", None)
WORDS = ("slow", "fast", "sad", "left_leg")


def indexed(clip_id: str, array: np.ndarray | None = None, **labels: Any) -> IndexedClip:
    """A ready clip with labels, by default with none."""
    defaults: dict[str, Any] = {"person": None, "task": None, "license": None, "source": None}
    defaults |= {"duration": 1.0, "words": frozenset()}
    return IndexedClip(id=clip_id, is_ready=True, array=array, **defaults | labels)


LABELS = st.fixed_dictionaries(
    {
        "person": st.sampled_from(PERSONS),
        "task": st.sampled_from(TASKS),
        "license": st.sampled_from(("CC0", None)),
        "source": st.sampled_from(("studio", "field")),
        "duration": st.sampled_from((0.0, 1.0, 2.5)),
        "measures": st.tuples(*[st.sampled_from((math.nan, 0.0, 1.0, 2.5))] * len(FOUND)),
        "words": st.frozensets(st.sampled_from(WORDS), max_size=3),
        "folder": st.sampled_from((None, "", "cmu", "cmu/02", "cmu 2", "CMU/02")),
        "metadata": st.dictionaries(
            st.sampled_from(("age", "fresh")), st.sampled_from((True, 30, 41.5, "30", "old"))
        ).map(lambda values: tuple(values.items())),
    }
)

CONDITIONS = st.builds(
    MetadataCondition,
    key=st.sampled_from(("age", "fresh", "unheard")),
    texts=st.sampled_from(((), ("30",), ("old", "true"))),
    minimum=st.sampled_from((None, 30.0, 40.0)),
    maximum=st.sampled_from((None, 30.0, 50.0)),
    is_negated=st.booleans(),
)

LEAVES = st.builds(
    ClipFilter,
    person=st.lists(st.sampled_from(("ada", "bruno", "nobody")), max_size=2).map(tuple),
    task=st.lists(st.sampled_from(("walk", "run")), max_size=2).map(tuple),
    license=st.sampled_from(((), ("CC0",))),
    source=st.sampled_from(((), ("studio",), ("studio", "elsewhere"))),
    word=st.lists(st.sampled_from((*WORDS, "unheard")), max_size=2).map(tuple),
    min_duration=st.sampled_from((None, 1.0, 2.0)),
    max_duration=st.sampled_from((None, 1.0, 0.5)),
    min_speed=st.sampled_from((None, None, 0.0, 1.0)),
    max_speed=st.sampled_from((None, None, 1.0)),
    max_tempo=st.sampled_from((None, None, 2.0)),
    folder=st.lists(st.sampled_from(("cmu", "cmu/02", "none")), max_size=2).map(tuple),
    not_folder=st.lists(st.sampled_from(("cmu", "cmu/02", "none")), max_size=1).map(tuple),
    metadata=st.lists(CONDITIONS, max_size=2).map(tuple),
)


def _above(below: st.SearchStrategy[ClipFilter]) -> st.SearchStrategy[ClipFilter]:
    """Filters that have others below them."""
    some = st.lists(below, max_size=2).map(tuple)
    word = st.sampled_from(((), (), ("slow",)))
    return st.builds(ClipFilter, all_of=some, any_of=some, none_of=some, word=word)


FILTERS = st.recursive(LEAVES, _above, max_leaves=6)
"""Filters, and trees of filters."""


def passes(clip: IndexedClip, clip_filter: ClipFilter) -> bool:
    """Whether a clip passes a tree of filters, without an index."""
    if not all(passes(clip, one) for one in clip_filter.all_of):
        return False
    if clip_filter.any_of and not any(passes(clip, one) for one in clip_filter.any_of):
        return False
    if any(passes(clip, one) for one in clip_filter.none_of):
        return False
    return _passes_alone(clip, clip_filter)


def _passes_alone(clip: IndexedClip, clip_filter: ClipFilter) -> bool:
    """Whether a clip meets the conditions of a filter, without those below it."""
    for name in ("person", "task", "license", "source"):
        values = getattr(clip_filter, name)
        if values and getattr(clip, name) not in values:
            return False
    if clip_filter.word and not any(word in clip.words for word in clip_filter.word):
        return False
    if clip_filter.folder and not _is_in(clip.folder, clip_filter.folder):
        return False
    if clip_filter.not_folder and _is_in(clip.folder, clip_filter.not_folder):
        return False
    if not all(_meets(clip, condition) for condition in clip_filter.metadata):
        return False
    return all(
        _is_within(
            dict(zip(MEASURES, (clip.duration, *clip.measures), strict=True))[name],
            getattr(clip_filter, f"min_{name}"),
            getattr(clip_filter, f"max_{name}"),
        )
        for name in MEASURES
    )


def _is_within(value: float, least: float | None, most: float | None) -> bool:
    if least is None and most is None:
        return True
    if math.isnan(value) or (least is not None and value < least):
        return False
    return most is None or value <= most


def _is_in(folder: str | None, parents: tuple[str, ...]) -> bool:
    parts = None if folder is None else folder.split("/")
    return parts is not None and any(
        parts[: len(parent.split("/"))] == parent.split("/") for parent in parents
    )


def _meets(clip: IndexedClip, condition: MetadataCondition) -> bool:
    values = dict(clip.metadata)
    if condition.key not in values:
        return condition.is_negated
    value = values[condition.key]
    text = {True: "true", 30: "30", 41.5: "41.5"}.get(value, value)
    is_number = not isinstance(value, bool | str)
    is_met = not condition.texts or text in condition.texts
    if condition.minimum is not None:
        is_met &= is_number and value >= condition.minimum
    if condition.maximum is not None:
        is_met &= is_number and value <= condition.maximum
    return is_met is not condition.is_negated
