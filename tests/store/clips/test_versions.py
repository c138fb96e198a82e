"""The library version: only changes that searches can see raise it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import ClipNotFound
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.record import ClipState, ClipWarning
from app.store.database.engine import Tx
from app.store.jobs import outcomes
from app.store.store import Store
from tests.store.conftest import ON_ONE_STORE, AddClip, facts, new_clip

PROBLEM = {"code": "unreadable"}
Change = Callable[[Tx, str], object]


@pytest.mark.parametrize(
    ("change", "is_there"),
    [
        (lambda tx, clip_id: clips.patch(tx, clip_id, {"person": "ben"}), True),
        (lambda tx, clip_id: clips.patch(tx, clip_id, {"words": ("run",)}), True),
        (lambda tx, clip_id: clips.set_ready(tx, clip_id, facts()), True),
        (lambda tx, clip_id: clips.set_failed(tx, clip_id, PROBLEM), False),
        (lambda tx, clip_id: clips.delete_clip(tx, clip_id), False),
    ],
)
def test_a_change_of_a_ready_clip_raises_the_version(
    store: Store, add_clip: AddClip, change: Change, is_there: bool
) -> None:
    clip = add_clip("walk", ready=True)
    with store.write() as tx:
        before = library.version(tx)
        change(tx, clip.id)
        changes = library.changed_since(tx, before)
    assert changes.version == before + 1
    assert (changes.changed, changes.removed) == (
        ((clip.id,), ()) if is_there else ((), (clip.id,))
    )


def test_waiting_for_another_analysis_changes_nothing_that_a_search_sees(
    store: Store, add_clip: AddClip
) -> None:
    clip = add_clip("walk", ready=True)
    with store.write() as tx:
        before = library.version(tx)
        clips.requeue(tx, clip.id)
        clips.set_processing(tx, clip.id)
        clips.keep_analysis(tx, clip.id, ClipWarning("reanalysis_failed", "it is gone"))
        assert library.version(tx) == before
        assert clips.get(tx, clip.id).state is ClipState.READY


def test_clips_that_were_never_ready_are_not_among_the_changes(
    store: Store, add_clip: AddClip
) -> None:
    clip = add_clip("walk")
    with store.write() as tx:
        clips.patch(tx, clip.id, {"person": "ben"})
        clips.set_processing(tx, clip.id)
        clips.set_failed(tx, clip.id, PROBLEM)
        clips.requeue(tx, clip.id)
        clips.delete_clip(tx, clip.id)
        assert library.changed_since(tx, 0) == library.LibraryChanges(0, (), ())


ACTIONS: dict[str, Callable[[Tx, str], object]] = {
    "ready": lambda tx, clip_id: clips.set_ready(tx, clip_id, facts()),
    "failed": lambda tx, clip_id: clips.set_failed(tx, clip_id, PROBLEM),
    "requeue": clips.requeue,
    "label": lambda tx, clip_id: clips.patch(tx, clip_id, {"task": "jump"}),
    "delete": outcomes.remove_clip,
}


@ON_ONE_STORE
@given(steps=st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from(["sync", *ACTIONS]))))
def test_an_index_that_reads_changes_at_times_has_the_ready_clips(
    store: Store, steps: list[tuple[str, str]]
) -> None:
    """The index collects ids of changes; at the end they are compared with the table."""
    ids: dict[str, str] = {}
    with store.write() as tx:
        at = library.version(tx)
        indexed = set(library.changed_since(tx, 0).changed)
        for name, action in [*steps, ("a", "sync")]:
            if action == "sync":
                changes = library.changed_since(tx, at)
                indexed = (indexed | set(changes.changed)) - set(changes.removed)
                at = changes.version
                continue
            ids[name] = clips.add_or_get(tx, new_clip(name)).clip.id
            ACTIONS[action](tx, ids[name])
        assert indexed == set(library.changed_since(tx, 0).changed)
        for clip_id in ids.values():
            assert (clip_id in indexed) == _is_ready(tx, clip_id)


def _is_ready(tx: Tx, clip_id: str) -> bool:
    try:
        return clips.get(tx, clip_id).state is ClipState.READY
    except ClipNotFound:
        return False
