"""Labels that come with content that the library has: the rules, against a slow twin."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import Conflict
from app.services.clips.merging import OnConflict, has_moved, merge
from app.store.clips.record import ClipLabels, ClipRecord, NewClip
from tests.api.test_schemas import CLIP

VALUES = st.sampled_from((None, "a", "b", "c"))


def _stored(person: str | None, base: dict[str, Any], **changes: Any) -> ClipRecord:
    plain: dict[str, Any] = {"metadata": {}, "words": (), "task": None, "source": None}
    return dataclasses.replace(CLIP, **plain | changes, person=person, imported=base)


def _sent(person: str | None, **changes: Any) -> NewClip:
    return NewClip(
        "a" * 64, "a.bvh", 7, ClipLabels("a", person), sent=frozenset({"person"}), **changes
    )


def _after(
    base: str | None, stored: str | None, sent: str | None, policy: OnConflict
) -> str | None:
    """The value after an import, written as a table of all cases."""
    if policy is OnConflict.UPDATE:
        return sent
    if policy is OnConflict.KEEP:
        return stored
    nobody_edited = stored == base
    return sent if nobody_edited else stored


@given(VALUES, VALUES, VALUES, st.sampled_from(OnConflict))
def test_one_label(
    base: str | None, stored: str | None, sent: str | None, policy: OnConflict
) -> None:
    clip, new = _stored(stored, {"person": base}), _sent(sent)
    if policy is OnConflict.ERROR:
        if stored == sent:
            assert merge(clip, new, policy).differences == ()
        else:
            with pytest.raises(Conflict) as refused:
                merge(clip, new, policy)
            assert [place.location for place in refused.value.places] == ["person"]
        return
    merged = merge(clip, new, policy)
    after = merged.changes.get("person", stored)
    assert after == _after(base, stored, sent, policy)
    is_conflict = any(not one.applied for one in merged.differences)
    if policy is OnConflict.MERGE:
        assert is_conflict == (len({base, stored, sent}) == 3)
    assert [(one.stored, one.sent) for one in merged.differences] in ([], [(stored, sent)])
    assert bool(merged.differences) == (after != stored or is_conflict)


@given(st.lists(st.tuples(st.booleans(), VALUES), max_size=8))
def test_after_any_history_an_import_that_is_repeated_changes_nothing(
    history: list[tuple[bool, str | None]],
) -> None:
    clip, last = _stored(None, {}), None
    for is_edit, value in history:
        if is_edit:
            clip = dataclasses.replace(clip, person=value)
            continue
        clip, last = _applied(clip, _sent(value)), value
    if last is not None:
        once = _applied(clip, _sent(last))
        assert _applied(once, _sent(last)) == once


def _applied(clip: ClipRecord, new: NewClip) -> ClipRecord:
    return dataclasses.replace(clip, **merge(clip, new, OnConflict.MERGE).changes)


def test_metadata_words_and_hints_are_compared_one_by_one() -> None:
    base = {"words": ["slow"], "meta.age": 30, "frame_rate": 60.0}
    clip = _stored(None, base, words=("slow",), metadata={"age": 30, "note": "mine"})
    labels = ClipLabels("a", words=("fast",), metadata={"age": 31})
    sent = frozenset({"words", "meta.age", "meta.gone", "frame_rate"})
    new = NewClip("a" * 64, "a.bvh", 7, labels, sent=sent)
    merged = merge(clip, new, OnConflict.MERGE)
    assert [(one.field, one.stored, one.sent) for one in merged.differences] == [
        ("frame_rate", 60.0, None),
        ("meta.age", 30, 31),
        ("words", ["slow"], ["fast"]),
    ]
    assert merged.changes["metadata"] == {"age": 31}
    assert (merged.changes["words"], merged.changes["frame_rate"]) == (("fast",), None)


@pytest.mark.parametrize(
    ("old", "new", "together", "moved"),
    [
        (None, "a.bvh", [], True),
        ("in/a.bvh", "out/a.bvh", ["out/a.bvh"], True),
        ("in/a.bvh", "out/a.bvh", ["in/a.bvh", "out/a.bvh"], False),
        ("cmu/02/a.bvh", "02/a.bvh", ["02/a.bvh"], False),
        ("a.bvh", "cmu/a.bvh", ["cmu/a.bvh"], True),
        ("a.bvh", None, [], False),
    ],
)
def test_a_file_that_moved(
    old: str | None, new: str | None, together: list[str], moved: bool
) -> None:
    assert has_moved(_stored(None, {}, path=old), new, together) is moved
