"""The audit log has a row exactly for each change that was committed."""

from __future__ import annotations

from datetime import timedelta

import pytest

from app.errors import PageNotFound
from app.store import audit, keys
from app.store.audit import AuditFilter, Call
from app.store.database.ids import utc_now
from app.store.key_role import KeyRole
from app.store.store import Store

ALL = AuditFilter()


def _actions(store: Store, filter: AuditFilter = ALL) -> list[str]:
    with store.read() as tx:
        return [row.action for row in audit.list_page(tx, filter).items]


def test_a_call_is_recorded_once_by_its_first_change(store: Store) -> None:
    with audit.calling(Call("update_clip", key_id="k", address="10.0.0.1")):
        with store.write():
            audit.note(clip_id="clip_1", fields=["person"])
            audit.note(clip_id="clip_2", fields=["task"])
        with store.write():
            pass
    with store.write():
        audit.note(clip_id="clip_3")  # no call runs
    with store.read() as tx:
        (row,) = audit.list_page(tx, ALL).items
    assert (row.action, row.key_id, row.key_name) == ("update_clip", "k", None)
    assert (row.address, row.clip_id, row.details) == ("10.0.0.1", "clip_1", {"fields": ["person"]})


def test_a_change_that_is_undone_is_not_recorded(store: Store) -> None:
    with audit.calling(Call("delete_clip")):
        with pytest.raises(ZeroDivisionError), store.write():
            raise ZeroDivisionError
        assert _actions(store) == []
        with store.write():
            pass
    assert _actions(store) == ["delete_clip"]


def test_rows_are_filtered_and_paged_newest_first(store: Store) -> None:
    with store.write() as tx:
        made = keys.create(tx, KeyRole.READ, "laptop").record
    for number in range(5):
        with store.write() as tx:
            audit.add(tx, Call(f"action_{number}", key_id=made.id, clip_id=f"clip_{number % 2}"))
    assert _actions(store) == [f"action_{n}" for n in (4, 3, 2, 1, 0)]
    assert _actions(store, AuditFilter(clip_id="clip_1")) == ["action_3", "action_1"]
    assert _actions(store, AuditFilter(action="action_2", key_id=made.id)) == ["action_2"]
    assert _actions(store, AuditFilter(key_id="other")) == []
    with store.read() as tx:
        first = audit.list_page(tx, ALL, limit=3)
        rest = audit.list_page(tx, ALL, limit=3, cursor=first.next)
        assert {row.key_name for row in first.items} == {"laptop"}
        assert audit.total(tx, ALL).count == 5
        with pytest.raises(PageNotFound):
            audit.list_page(tx, ALL, cursor="x")
    assert [row.action for row in rest.items] == ["action_1", "action_0"]
    assert rest.next is None
    third = first.items[1].at
    assert _actions(store, AuditFilter(since=third)) == ["action_4", "action_3"]
    assert _actions(store, AuditFilter(until=third)) == ["action_2", "action_1", "action_0"]


def test_old_rows_are_removed_a_few_at_a_time(store: Store) -> None:
    for number in range(3):
        with store.write() as tx:
            audit.add(tx, Call(f"action_{number}"))
    end = utc_now() + timedelta(seconds=1)
    with store.write() as tx:
        assert audit.is_any_before(tx, end)
        assert audit.remove_before(tx, end, 2) == 2
    assert _actions(store) == ["action_2"]
    with store.write() as tx:
        assert audit.remove_before(tx, end, 2) == 1
        assert not audit.is_any_before(tx, end)
