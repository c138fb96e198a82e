"""Rows against a dictionary of clips: whatever comes, changes and goes, in any order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.search.index import rows as module
from app.search.index.rows import Layout, Rows, RowsView
from app.store.clips.filter import ClipFilter
from app.store.clips.index_feed import IndexedClip
from tests.search.indexed import FILTERS, LABELS, indexed, passes

ONE = Layout(("vector",), width=2)
MANY = Layout(("poses",), width=2, facts=1, several=True)
SMALL = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that few clips fill blocks, and few dead ones are dropped."""
    monkeypatch.setattr(module, "BLOCK", 5)
    monkeypatch.setattr(module, "MAX_FEW_DEAD", 3)
    monkeypatch.setattr(module, "COPY_BATCH", 2)


STEPS = st.lists(
    st.tuples(st.sampled_from("abcdefgh"), st.sampled_from(["put", "put", "remove"]), LABELS),
    max_size=25,
)


def _played(layout: Layout, steps: list[Any]) -> tuple[Rows, dict[str, IndexedClip]]:
    rows, kept = Rows(layout), {}
    for number, (clip_id, action, labels) in enumerate(steps):
        if action == "remove":
            rows.remove([clip_id])
            kept.pop(clip_id, None)
        else:
            kept[clip_id] = indexed(clip_id, _array(layout, number), **labels)
            rows.put([kept[clip_id]])
        if rows.is_wasteful:
            rows = rows.living()
    return rows, kept


def _array(layout: Layout, number: int) -> np.ndarray:
    if not layout.several:
        return np.array([number, -number], dtype=np.float32)
    count = 1 + number % 7
    return np.arange(count * 3, dtype=np.float32).reshape(count, 3) + 100 * number


def _words(view: RowsView) -> dict[str, frozenset[str]]:
    codes, sets = view.labels.word_sets()
    carried = zip(view.labels.ids, codes, view.labels.alive, strict=True)
    return {clip_id: sets[code] for clip_id, code, is_alive in carried if is_alive}


def _held(view: RowsView) -> dict[str, list[list[float]]]:
    """What each living clip's rows hold, read the slow way."""
    vectors = [row.tolist() for block in view.blocks for row in block.vectors]
    owners = range(len(vectors)) if view.owners is None else view.owners.tolist()
    found: dict[str, list[list[float]]] = {}
    for owner, facts, vector in zip(owners, view.facts.tolist(), vectors, strict=True):
        if view.labels.alive[owner]:
            found.setdefault(str(view.labels.ids[owner]), []).append([*facts, *vector])
    return found


@pytest.mark.parametrize("layout", [ONE, MANY], ids=["one row", "several rows"])
@SMALL
@given(steps=STEPS)
def test_rows_are_those_of_the_last_change(layout: Layout, steps: list[Any]) -> None:
    rows, kept = _played(layout, steps)
    assert len(rows) == len(kept)
    assert _held(rows.view()) == {
        clip_id: clip.array.reshape(-1, layout.facts + layout.width).tolist()
        for clip_id, clip in kept.items()
        if clip.array is not None
    }


@SMALL
@given(steps=STEPS, clip_filter=FILTERS, excluded=st.sampled_from("abz"))
def test_filters_select_the_same_clips_as_a_loop(
    steps: list[Any], clip_filter: Any, excluded: str
) -> None:
    rows, kept = _played(ONE, steps)
    labels = rows.view().labels
    found = labels.ids[labels.mask(clip_filter, [excluded])]
    expected = {i for i, clip in kept.items() if passes(clip, clip_filter) and i != excluded}
    assert sorted(found) == sorted(expected)


@SMALL
@given(before=STEPS, after=STEPS)
def test_a_view_stays_as_it_was(before: list[Any], after: list[Any]) -> None:
    rows, _ = _played(MANY, before)
    view = rows.view()
    held = _held(view)
    words = _words(view)
    for number, (clip_id, action, labels) in enumerate(after, 1000):
        if action == "remove":
            rows.remove([clip_id])
        else:
            rows.put([indexed(clip_id, _array(MANY, number), **labels)])
    assert _held(view) == held
    excluded = {clip_id: view.labels.mask(ClipFilter(), [clip_id]).sum() for clip_id in held}
    assert set(excluded.values()) <= {len(held) - 1}
    assert _words(view) == words
    assert words.keys() == held.keys()


def test_masks_select_the_rows_of_the_clips_that_pass() -> None:
    rows = Rows(MANY)
    rows.put([indexed(name, _array(MANY, n)) for n, name in enumerate("abc", 3)])
    view = rows.view()
    masks = view.masks(np.array([True, False, True]))
    assert [len(mask) for mask in masks] == [len(block) for block in view.blocks]
    assert np.concatenate(masks).tolist() == [True] * 4 + [False] * 5 + [True] * 6
    assert view.starts is not None
    assert view.starts.tolist() == [0, 4, 9]


@pytest.mark.parametrize("array", [None, np.zeros((0, 3)), np.zeros((2, 4)), np.zeros(3)])
def test_a_clip_of_an_earlier_analysis_is_left_out(array: np.ndarray | None) -> None:
    rows = Rows(MANY)
    rows.put([indexed("old", array), indexed("new", np.zeros((2, 3)))])
    assert list(_held(rows.view())) == ["new"]
    rows.put([indexed("new", array)])
    assert len(rows) == 0


def test_dead_rows_are_dropped_if_they_are_the_majority() -> None:
    rows = Rows(ONE)
    rows.put([indexed(f"c{i}", _array(ONE, i), words=frozenset({"w"})) for i in range(9)])
    rows.remove([f"c{i}" for i in range(7)])
    assert rows.is_wasteful
    living = rows.living()
    assert not living.is_wasteful
    assert _held(living.view()) == {"c7": [[7.0, -7.0]], "c8": [[8.0, -8.0]]}
    assert _words(living.view()) == {"c7": {"w"}, "c8": {"w"}}
