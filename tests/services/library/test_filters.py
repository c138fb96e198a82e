"""Filters with kinds of labels, and the tree of a library."""

from __future__ import annotations

import pytest

from app.errors import BadField
from app.search.index.filters import parse_filter
from app.services.clips import catalogue as clips
from app.services.clips import persons
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.filters import resolved_filter
from app.services.library.label_tree import get_tree, put_parents
from app.services.library.library import Library
from app.store.clips import clip_annotations
from app.store.clips.clip_annotations import NewAnnotation
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord


@pytest.fixture
def kicks(mine: Library) -> list[ClipRecord]:
    """Three kicks: a "right leg kick", a "kick" and a "jog"."""
    found = [c for c in clips.list_clips(mine, sort="name", limit=100).items if c.task == "kick"]
    clips.update_clip(mine, found[0].id, {"task": "right leg kick", "words": ["right_kick"]})
    clips.update_clip(mine, found[2].id, {"task": "jog", "words": []})
    return found


def listed(lib: Library, **filters: tuple[str, ...]) -> set[str]:
    page = clips.list_clips(lib, ClipFilter(**filters), limit=100)  # type: ignore[arg-type]
    return {clip.id for clip in page.items}


def searched(lib: Library, clip: ClipRecord, **filters: str) -> set[str]:
    query = MotionQuery(QuerySource(clip_id=clip.id), filter=filters, limit=100, include_self=True)
    return {hit.clip.id for hit in find_motion(lib, query).items}


def test_a_task_means_all_kinds_of_it(mine: Library, kicks: list[ClipRecord]) -> None:
    ids = [clip.id for clip in kicks]
    for find in (lambda **f: listed(mine, **f), lambda **f: searched(mine, kicks[0], **f)):
        assert find(task=("kick",)) == set(ids[:2])
        assert find(task=("=kick",)) == {ids[1]}
        assert find(task=("right leg kick",)) == {ids[0]}
        assert find(task=("run",)) == {ids[2]}
        assert find(task=("=run",)) == set()
        others = find(not_task=("kick", "run"))
        assert not others & set(ids)
        assert ids[0] in find(not_task=("=kick",))
        assert ids[0] in find(word=("kick",))
        assert ids[0] not in find(word=("=kick",))


def test_kinds_are_looked_up_as_the_tree_finds_them(mine: Library, kicks: list[ClipRecord]) -> None:
    found = get_tree(mine)
    for node in [*found.tree.nodes, "nosuch", "Right-Leg Kick"]:
        assert found.kinds_of(node, "tasks") == found.tree.kinds(node, found.tasks)
        assert found.kinds_of(node, "words") == found.tree.kinds(node, found.words)
    assert len(kicks) == 3


def test_people_change_the_tree(mine: Library, kicks: list[ClipRecord]) -> None:
    assert get_tree(mine).tree.path("jog")[:2] == ("jog", "run")
    put_parents(mine, {"Jog": "kick", "right leg kick": None})
    assert listed(mine, task=("kick",)) == {kicks[1].id, kicks[2].id}
    put_parents(mine, {})
    assert listed(mine, task=("kick",)) == {kicks[0].id, kicks[1].id}


@pytest.mark.parametrize("parents", [{"a": "a"}, {"a": "b", "b": "a"}, {" ": "a"}])
def test_a_tree_that_cannot_be_is_refused(mine: Library, parents: dict[str, str | None]) -> None:
    with pytest.raises(BadField):
        put_parents(mine, parents)


def test_a_new_label_is_in_the_tree_at_once(mine: Library, kicks: list[ClipRecord]) -> None:
    assert "moonwalk_on_toes" not in get_tree(mine).tree.nodes
    clips.update_clip(mine, kicks[0].id, {"task": "walk on toes"})
    assert kicks[0].id in listed(mine, task=("walk",))


def test_a_filter_without_labels_stays_as_it_is(mine: Library) -> None:
    asked = ClipFilter(person=("ada",))
    assert resolved_filter(mine, asked) is asked


def test_a_forgotten_person_leaves_the_tree(mine: Library) -> None:
    put_parents(mine, {"ada": "walk", "bow": "ada", "jog": "walk"})
    persons.forget_person(mine, "ada")
    assert "ada" not in get_tree(mine).tree.nodes
    assert get_tree(mine).tree.path("jog")[1] == "walk"


def test_kinds_and_collections_count_within_trees(mine: Library, kicks: list[ClipRecord]) -> None:
    ids = [clip.id for clip in kicks]
    tree = {"any_of": [{"task": "kick"}, {"task": "=jog"}], "none_of": [{"task": "=kick"}]}
    page = clips.list_clips(mine, parse_filter(tree), limit=100)
    assert {clip.id for clip in page.items} == {ids[0], ids[2]}
    query = MotionQuery(QuerySource(clip_id=ids[0]), filter=tree, limit=100, include_self=True)
    assert {hit.clip.id for hit in find_motion(mine, query).items} == {ids[0], ids[2]}
    with pytest.raises(BadField):
        resolved_filter(mine, {"none_of": [{"collection": "collection_none"}]})


def test_words_of_annotations_are_found(mine: Library, kicks: list[ClipRecord]) -> None:
    said = NewAnnotation(0.0, 0.5, words=("grösser", "jog"))
    with mine.store.write() as tx:
        clip_annotations.add(tx, kicks[1].id, said)
    for word in ("jog", "größer"):
        for given in ({"annotation": word}, {"where": {"annotation": [word, "bow"]}}):
            page = clips.list_clips(mine, parse_filter(given))
            assert {clip.id for clip in page.items} == {kicks[1].id}
            assert searched(mine, kicks[0], **given) == {kicks[1].id}  # type: ignore[arg-type]
    assert not clips.list_clips(mine, parse_filter({"annotation": "jo"})).items
