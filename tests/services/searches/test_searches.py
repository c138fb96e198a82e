"""Saved searches: what is new since the last look, and what forgetting does."""

from __future__ import annotations

import pytest

from app.demo import demo_clips
from app.errors import BadField, Conflict, SearchNotFound
from app.services.clips import catalogue as clips
from app.services.clips import persons
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.searches import searches
from app.store.clips.record import ClipRecord
from tests.libraries import upload, work


@pytest.fixture
def kick(mine: Library) -> ClipRecord:
    return next(c for c in clips.list_clips(mine, limit=100).items if c.task == "kick")


def like(clip: ClipRecord, limit: int = 4) -> ComposedQuery:
    return ComposedQuery([Example("examples.0", QuerySource(clip_id=clip.id))], limit=limit)


def new_ids(lib: Library, search_id: str, query: ComposedQuery) -> list[str]:
    found = searches.new_hits(lib, searches.get(lib, search_id), query)
    return [hit.clip.id for hit in found.items]


def test_a_clip_that_comes_is_new_until_it_is_seen(mine: Library, kick: ClipRecord) -> None:
    query = like(kick)
    saved = searches.save(mine, "kicks", query, {"limit": 4})
    assert new_ids(mine, saved.id, query) == []
    take = list(demo_clips([kick.person or ""], ["kick"], takes=2))[1]
    created = upload(mine, take)
    work(mine.settings)
    assert new_ids(mine, saved.id, query) == [created.clip.id]
    assert new_ids(mine, saved.id, query) == [created.clip.id]
    searches.look_at(mine, saved.id, query)
    assert new_ids(mine, saved.id, query) == []


def test_a_hit_that_only_moves_up_is_not_new(mine: Library, kick: ClipRecord) -> None:
    query = like(kick)
    saved = searches.save(mine, "kicks", query, {})
    first = find_by_parts(mine, query).items[0].clip.id
    clips.delete_clip(mine, first)
    assert len(find_by_parts(mine, query).items) == 4
    assert new_ids(mine, saved.id, query) == []


def test_a_clip_that_gets_a_label_of_the_filter_is_new(mine: Library, kick: ClipRecord) -> None:
    query = ComposedQuery(words=["walk"], filter={"task": "stroll"}, limit=5)
    saved = searches.save(mine, "strolls", query, {})
    clips.update_clip(mine, kick.id, {"task": "stroll"})
    assert new_ids(mine, saved.id, query) == [kick.id]


def test_names_are_unique_and_searches_change(mine: Library, kick: ClipRecord) -> None:
    one = searches.save(mine, "one", like(kick), {"limit": 4})
    two = searches.save(mine, "two", like(kick), {})
    with pytest.raises(Conflict):
        searches.save(mine, "one", like(kick), {})
    with pytest.raises(Conflict):
        searches.change(mine, two.id, name="one")
    with pytest.raises(BadField):
        searches.save(mine, " ", like(kick), {})
    changed = searches.change(mine, one.id, query=like(kick, 2), as_sent={"limit": 2})
    assert (changed.name, changed.query, len(changed.seen)) == ("one", {"limit": 2}, 2)
    assert [search.id for search in searches.list_page(mine, 10).items] == [two.id, one.id]
    searches.remove(mine, one.id)
    with pytest.raises(SearchNotFound):
        searches.get(mine, one.id)


def test_searches_for_a_forgotten_person_go(mine: Library, kick: ClipRecord) -> None:
    query = like(kick)
    by_ada = searches.save(mine, "a", query, {"filter": {"person": ["ada"]}})
    named = searches.save(mine, "what ada does", query, {"words": ["walk like ada"]})
    other = searches.save(mine, "b", query, {"words": ["walk"]})
    persons.forget_person(mine, "ada")
    with pytest.raises(SearchNotFound):
        searches.get(mine, by_ada.id)
    after = searches.get(mine, named.id)
    assert "ada" not in after.name + str(after.query)
    assert searches.get(mine, other.id) == other
