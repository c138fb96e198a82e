"""API keys are shown once, checked by their hash, and can be revoked."""

from __future__ import annotations

import pytest

from app.errors import NotFound
from app.store import keys
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
