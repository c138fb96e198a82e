"""Columns of labels say of each clip what its record says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.search.index.label_columns import (
    NO_VALUE,
    label_columns,
    metadata_columns,
    word_column,
)
from app.search.index.labels import Labels
from app.store.clips.index_feed import IndexedClip
from app.store.clips.measures import FOUND

PLAIN = IndexedClip(
    id="",
    is_ready=True,
    person=None,
    task=None,
    license=None,
    source=None,
    folder=None,
    duration=1.0,
    words=frozenset(),
    metadata=(),
    measures=(float("nan"),) * len(FOUND),
    array=None,
)
CLIPS = [
    replace(PLAIN, id="a", task="walk", words=frozenset({"slow", "left"})),
    replace(PLAIN, id="b", person="ada", task="kick", metadata=(("age", 30), ("ok", True))),
    replace(PLAIN, id="c", task="walk", metadata=(("age", "30"), ("trial", "x"))),
    replace(PLAIN, id="d", metadata=(("age", 30),)),
]


def test_each_clip_has_its_own_values() -> None:
    labels = Labels()
    labels.add(CLIPS)
    order = np.array([2, 0, 3, 1])
    view = labels.view()
    for name, column in label_columns(view, order).items():
        assert None not in column.values
        labeled = [column.values[code] if code != NO_VALUE else None for code in column.codes]
        assert labeled == [getattr(CLIPS[number], name) for number in order]
    words = word_column(view, order)
    assert [set(words.values[code]) for code in words.codes] == [CLIPS[n].words for n in order]
    metadata = metadata_columns(view, order)
    assert list(metadata) == ["age", "ok", "trial"]
    for key, found in metadata.items():
        has = [place for place, number in enumerate(order) if key in dict(CLIPS[number].metadata)]
        assert found.clips.tolist() == has
        for place, code in zip(found.clips, found.column.codes, strict=True):
            value, own = found.column.values[code], dict(CLIPS[order[place]].metadata)[key]
            assert (value, type(value)) == (own, type(own))


def test_values_that_no_chosen_clip_has_are_left_out() -> None:
    labels = Labels()
    labels.add(CLIPS)
    labels.remove(["b"])
    labels.add([replace(CLIPS[1], task="jump")])
    living = np.flatnonzero(labels.view().alive)
    assert set(label_columns(labels.view(), living)["task"].values) == {"walk", "jump"}
    assert list(metadata_columns(labels.view(), np.array([0]))) == []
    nobody = np.array([], dtype=np.int64)
    assert list(label_columns(labels.view(), nobody)["task"].codes) == []
    assert metadata_columns(labels.view(), nobody) == {}
