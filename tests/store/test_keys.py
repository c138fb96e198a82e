"""API keys are shown once, checked by their hash, and can be revoked."""

from __future__ import annotations

from datetime import timedelta

import pytest

from app.errors import BadField, NotFound
from app.store import keys
from app.store.database.ids import utc_now
from app.store.key_role import KeyRole
from app.store.store import Store


def test_a_key_is_valid_until_it_is_revoked(store: Store) -> None:
    with store.write() as tx:
        assert not keys.is_any_valid(tx)
        created = keys.create(tx, KeyRole.WRITE, "laptop")
        assert created.secret.startswith("kx_")
        assert keys.verify(tx, created.secret) == created.record
        assert keys.is_any_valid(tx)
        revoked = keys.revoke(tx, created.record.id)
        assert revoked.revoked_at is not None
        assert keys.revoke(tx, created.record.id) == revoked
        assert keys.verify(tx, created.secret) is None
        assert not keys.is_any_valid(tx)
        assert keys.list_keys(tx) == (revoked,)


def test_wrong_secrets_are_not_accepted(store: Store) -> None:
    with store.write() as tx:
        secret = keys.create(tx, KeyRole.READ, "a").secret
        other = keys.create(tx, KeyRole.ADMIN, "b").secret
        mixed = "_".join([*secret.split("_", 2)[:2], other.split("_", 2)[2]])
        for wrong in ("", "kx", "kx_", secret[:-1], secret + "x", mixed, "\ud800", secret.upper()):
            assert keys.verify(tx, wrong) is None


def test_the_secret_is_neither_stored_nor_shown(store: Store) -> None:
    with store.write() as tx:
        created = keys.create(tx, KeyRole.READ, "a")
        row = tx.exec_driver_sql("SELECT * FROM api_keys").one()
    hidden = created.secret.split("_", 2)[2]
    assert hidden not in repr(created)
    assert not any(hidden in str(value) for value in row)


def test_an_unknown_key_cannot_be_revoked(store: Store) -> None:
    with pytest.raises(NotFound), store.write() as tx:
        keys.revoke(tx, "nothing")


def test_each_role_includes_the_rights_of_lower_roles() -> None:
    allowed = [[role.allows(needed) for needed in KeyRole] for role in KeyRole]
    assert allowed == [[True, False, False], [True, True, False], [True, True, True]]


def test_a_key_ends_at_its_time(store: Store) -> None:
    now = utc_now()
    with store.write() as tx:
        created = keys.create(tx, KeyRole.READ, "a", expires_at=now + timedelta(days=1))
        assert keys.verify(tx, created.secret, now) == created.record
        assert keys.is_any_valid(tx)
        assert keys.verify(tx, created.secret, now + timedelta(days=1)) is None
        keys.create(tx, KeyRole.READ, "old", expires_at=now)
        keys.revoke(tx, created.record.id)
        assert not keys.is_any_valid(tx)
        assert keys.is_any(tx)


def test_the_last_use_is_stored_once_a_minute(store: Store) -> None:
    now = utc_now()
    with store.write() as tx:
        created = keys.create(tx, KeyRole.READ, "a")
        assert created.record.is_use_due(now)
        for seconds, stored in ((0, 0), (59, 0), (60, 60), (90, 60)):
            keys.note_use(tx, created.record.id, now + timedelta(seconds=seconds))
            (record,) = keys.list_keys(tx)
            assert record.used_at == now + timedelta(seconds=stored)
    assert not record.is_use_due(now + timedelta(seconds=90))
    assert record.is_use_due(now + timedelta(seconds=120))


def test_a_key_for_one_source_can_only_read(store: Store) -> None:
    with store.write() as tx:
        assert keys.create(tx, KeyRole.READ, "a", source="lab").record.source == "lab"
    for role in (KeyRole.WRITE, KeyRole.ADMIN):
        with pytest.raises(BadField), store.write() as tx:
            keys.create(tx, role, "a", source="lab")
