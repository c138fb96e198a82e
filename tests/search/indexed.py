"""Generated clips for an index, and a filter that checks one clip at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from app.store.clips.filter import ClipFilter
from app.store.clips.index_feed import IndexedClip

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
        "words": st.frozensets(st.sampled_from(WORDS), max_size=3),
    }
)

FILTERS = st.builds(
    ClipFilter,
    person=st.lists(st.sampled_from(("ada", "bruno", "nobody")), max_size=2).map(tuple),
    task=st.lists(st.sampled_from(("walk", "run")), max_size=2).map(tuple),
    license=st.sampled_from(((), ("CC0",))),
    source=st.sampled_from(((), ("studio",), ("studio", "elsewhere"))),
    word=st.lists(st.sampled_from((*WORDS, "unheard")), max_size=2).map(tuple),
    min_duration=st.sampled_from((None, 1.0, 2.0)),
    max_duration=st.sampled_from((None, 1.0, 0.5)),
)


def passes(clip: IndexedClip, clip_filter: ClipFilter) -> bool:
    """Whether a clip passes a filter, without an index."""
    for name in ("person", "task", "license", "source"):
        values = getattr(clip_filter, name)
        if values and getattr(clip, name) not in values:
            return False
    if clip_filter.word and not any(word in clip.words for word in clip_filter.word):
        return False
    if clip_filter.min_duration is not None and clip.duration < clip_filter.min_duration:
        return False
    return clip_filter.max_duration is None or clip.duration <= clip_filter.max_duration
