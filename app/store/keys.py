"""API keys: shown once, stored as a hash, checked in constant time.

A key is `kx_<public part>_<secret part>`. The public part selects the row; then the hash of the
whole key is compared. The secret part has 256 random bits, so one round of SHA-256 is enough.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import (
    ColumnElement,
    RowMapping,
    and_,
    bindparam,
    exists,
    insert,
    or_,
    select,
    update,
)

from app.errors import BadField, NotFound
from app.kinedex_error import Place
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.service_tables import api_keys
from app.store.key_role import KeyRole

PREFIX = "kx"
PUBLIC_BYTES = 6
SECRET_BYTES = 32
_NO_HASH = "0" * 64
"""Compared if there is no such key, so that the answer takes the same time."""
USE_INTERVAL = timedelta(minutes=1)
"""The last use of a key is stored at most once in this time."""

# Built once, because every API call executes them.
_IS_ANY = select(exists(select(api_keys.c.id)))
_BY_ID = select(api_keys).where(api_keys.c.id == bindparam("the_id"))


@dataclass(frozen=True, slots=True)
class KeyRecord:
    """A key without its secret.

    source: the only source whose clips the key may read, None for all; expires_at: when it ends,
    None for never; used_at: its last use, None before the first.
    """

    id: str
    name: str
    role: KeyRole
    created_at: datetime
    revoked_at: datetime | None
    source: str | None = None
    expires_at: datetime | None = None
    used_at: datetime | None = None

    def is_use_due(self, now: datetime) -> bool:
        """Whether a use at `now` is to be stored (`note_use`)."""
        return self.used_at is None or now - self.used_at >= USE_INTERVAL


@dataclass(frozen=True, slots=True)
class CreatedKey:
    """A new key with its secret, which is not stored: nobody can read it later. repr hides it."""

    record: KeyRecord
    secret: str

    def __repr__(self) -> str:
        return f"CreatedKey(record={self.record!r}, secret=...)"


def create(
    tx: Tx,
    role: KeyRole,
    name: str,
    *,
    source: str | None = None,
    expires_at: datetime | None = None,
) -> CreatedKey:
    """Makes a key. The database stores only the hash of its secret.

    source: the only source whose clips the key may read. Raises BadField if the role is more than
    `read` then.
    """
    if source is not None and role is not KeyRole.READ:
        raise BadField(
            "A key for one source can only read.",
            places=[Place("role", "must be `read` with a source")],
        )
    key_id = secrets.token_hex(PUBLIC_BYTES)
    secret = f"{PREFIX}_{key_id}_{secrets.token_urlsafe(SECRET_BYTES)}"
    added = insert(api_keys).values(
        id=key_id,
        name=name,
        role=role.value,
        secret_sha256=_hash(secret),
        created_at=utc_now(),
        source=source,
        expires_at=expires_at,
    )
    return CreatedKey(_to_record(tx.execute(added.returning(api_keys)).mappings().one()), secret)


def verify(tx: Tx, secret: str, now: datetime | None = None) -> KeyRecord | None:
    """The key with this secret; None if it is unknown, revoked or expired."""
    parts = secret.split("_", 2)
    key_id = parts[1] if len(parts) == 3 and parts[0] == PREFIX else ""
    row = tx.execute(_BY_ID, {"the_id": key_id}).mappings().one_or_none()
    stored = _NO_HASH if row is None else row["secret_sha256"]
    same = hmac.compare_digest(stored, _hash(secret))
    if row is None or not same or _has_ended(row, now or utc_now()):
        return None
    return _to_record(row)


def valid(tx: Tx, key_id: str, now: datetime | None = None) -> KeyRecord | None:
    """The key with this public id; None if it is unknown, revoked or expired."""
    row = tx.execute(_BY_ID, {"the_id": key_id}).mappings().one_or_none()
    return None if row is None or _has_ended(row, now or utc_now()) else _to_record(row)


def note_use(tx: Tx, key_id: str, now: datetime) -> None:
    """Stores the last use of a key, unless one within USE_INTERVAL is stored."""
    is_due = or_(api_keys.c.used_at.is_(None), api_keys.c.used_at <= now - USE_INTERVAL)
    tx.execute(update(api_keys).where(api_keys.c.id == key_id, is_due).values(used_at=now))


def is_any(tx: Tx) -> bool:
    """Whether there is any key, even a revoked or expired one."""
    return bool(tx.execute(_IS_ANY).scalar_one())


def is_any_valid(tx: Tx) -> bool:
    """Whether there is a key that is neither revoked nor expired."""
    return bool(tx.execute(select(exists().where(_is_valid(utc_now())))).scalar_one())


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


def _is_valid(now: datetime) -> ColumnElement[bool]:
    has_time = or_(api_keys.c.expires_at.is_(None), api_keys.c.expires_at > now)
    return and_(api_keys.c.revoked_at.is_(None), has_time)


def _has_ended(row: RowMapping, now: datetime) -> bool:
    has_expired = row["expires_at"] is not None and row["expires_at"] <= now
    return has_expired or row["revoked_at"] is not None


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()


def _to_record(row: RowMapping) -> KeyRecord:
    return KeyRecord(
        id=row["id"],
        name=row["name"],
        role=KeyRole(row["role"]),
        created_at=row["created_at"],
        revoked_at=row["revoked_at"],
        source=row["source"],
        expires_at=row["expires_at"],
        used_at=row["used_at"],
    )
