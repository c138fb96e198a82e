"""API keys: shown once, stored as a hash, checked in constant time.

A key is `kx_<public part>_<secret part>`. The public part selects the row; then the hash of the
whole key is compared. The secret part has 256 random bits, so one round of SHA-256 is enough.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import RowMapping, bindparam, exists, insert, select, update

from app.errors import NotFound
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import api_keys
from app.store.key_role import KeyRole

PREFIX = "kx"
PUBLIC_BYTES = 6
SECRET_BYTES = 32
_NO_HASH = "0" * 64
"""Compared if there is no such key, so that the answer takes the same time."""

# Built once, because every API call executes them.
_IS_ANY = select(exists(select(api_keys.c.id)))
_BY_ID = select(api_keys).where(api_keys.c.id == bindparam("the_id"))


@dataclass(frozen=True, slots=True)
class KeyRecord:
    """A key without its secret."""

    id: str
    name: str
    role: KeyRole
    created_at: datetime
    revoked_at: datetime | None


@dataclass(frozen=True, slots=True)
class CreatedKey:
    """A new key with its secret, which is not stored: nobody can read it later. repr hides it."""

    record: KeyRecord
    secret: str

    def __repr__(self) -> str:
        return f"CreatedKey(record={self.record!r}, secret=...)"


def create(tx: Tx, role: KeyRole, name: str) -> CreatedKey:
    """Makes a key. The database stores only the hash of its secret."""
    key_id = secrets.token_hex(PUBLIC_BYTES)
    secret = f"{PREFIX}_{key_id}_{secrets.token_urlsafe(SECRET_BYTES)}"
    added = insert(api_keys).values(
        id=key_id,
        name=name,
        role=role.value,
        secret_sha256=_hash(secret),
        created_at=utc_now(),
    )
    return CreatedKey(_to_record(tx.execute(added.returning(api_keys)).mappings().one()), secret)


def verify(tx: Tx, secret: str) -> KeyRecord | None:
    """The key with this secret; None if it is unknown or revoked."""
    parts = secret.split("_", 2)
    key_id = parts[1] if len(parts) == 3 and parts[0] == PREFIX else ""
    row = tx.execute(_BY_ID, {"the_id": key_id}).mappings().one_or_none()
    stored = _NO_HASH if row is None else row["secret_sha256"]
    same = hmac.compare_digest(stored, _hash(secret))
    if row is None or not same or row["revoked_at"] is not None:
        return None
    return _to_record(row)


def is_any(tx: Tx) -> bool:
    """Whether there is any key, even a revoked one."""
    return bool(tx.execute(_IS_ANY).scalar_one())


def is_any_valid(tx: Tx) -> bool:
    """Whether there is a key that has not been revoked."""
    return bool(tx.execute(select(exists().where(api_keys.c.revoked_at.is_(None)))).scalar_one())


def list_keys(tx: Tx) -> tuple[KeyRecord, ...]:
    """All keys, revoked ones too, oldest first."""
    query = select(api_keys).order_by(api_keys.c.created_at, api_keys.c.id)
    return tuple(_to_record(row) for row in tx.execute(query).mappings())


def revoke(tx: Tx, key_id: str) -> KeyRecord:
    """Revokes a key: after the commit it allows nothing. Raises NotFound."""
    revoked = (
        update(api_keys)
        .where(api_keys.c.id == key_id, api_keys.c.revoked_at.is_(None))
        .values(revoked_at=utc_now())
    )
    tx.execute(revoked)
    row = tx.execute(_BY_ID, {"the_id": key_id}).mappings().one_or_none()
    if row is None:
        raise NotFound(f"There is no API key with the id {key_id!r}")
    return _to_record(row)


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def _to_record(row: RowMapping) -> KeyRecord:
    return KeyRecord(
        id=row["id"],
        name=row["name"],
        role=KeyRole(row["role"]),
        created_at=row["created_at"],
        revoked_at=row["revoked_at"],
    )
