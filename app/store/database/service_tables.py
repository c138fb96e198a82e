"""The tables of the service itself: keys, who did what, webhooks, and calls that are repeated."""

from __future__ import annotations

from sqlalchemy import Boolean, Column, ForeignKey, Index, Integer, LargeBinary, String, Table

from app.store.database.columns import UtcDateTime, json_column, metadata

api_keys = Table(
    "api_keys",
    metadata,
    Column("id", String, primary_key=True),
    Column("name", String, nullable=False),
    Column("role", String, nullable=False),
    Column("secret_sha256", String, nullable=False),
    Column("created_at", UtcDateTime, nullable=False),
    Column("revoked_at", UtcDateTime),
    # The only source whose clips the key may read: see `clips.visibility`.
    Column("source", String),
    Column("expires_at", UtcDateTime),
    # The last use, at most a minute old: see `keys.note_use`.
    Column("used_at", UtcDateTime),
)

# Who changed or exported what: see `audit`. Rows are only added, and removed when they are old.
audit_log = Table(
    "audit_log",
    metadata,
    Column("id", String, primary_key=True),
    Column("at", UtcDateTime, nullable=False, index=True),
    Column("action", String, nullable=False),
    # No foreign keys: the row outlives the clip. No name of the key: it is read from `api_keys`.
    Column("key_id", String, index=True),
    Column("address", String),
    Column("clip_id", String, index=True),
    json_column("details", nullable=False),
)

webhooks = Table(
    "webhooks",
    metadata,
    Column("id", String, primary_key=True),
    Column("url", String, nullable=False),
    Column("secret", String, nullable=False),
    json_column("events", nullable=False),
    Column("is_enabled", Boolean, nullable=False, index=True),
    # Failures without a success in between, and when the next delivery is due.
    Column("failures", Integer, nullable=False),
    Column("not_before", UtcDateTime),
    json_column("last_delivery"),
    Column("created_at", UtcDateTime, nullable=False),
)

# Events that a webhook still has to receive.
webhook_deliveries = Table(
    "webhook_deliveries",
    metadata,
    Column("id", String, primary_key=True),
    Column(
        "webhook_id",
        String,
        ForeignKey("webhooks.id", ondelete="CASCADE"),
        nullable=False,
    ),
    Column("event", String, nullable=False),
    Column("body", String, nullable=False),
    Column("attempts", Integer, nullable=False),
    Column("created_at", UtcDateTime, nullable=False),
    Index(None, "webhook_id", "created_at"),
)

# Calls with an Idempotency-Key, and their answers.
keyed_calls = Table(
    "keyed_calls",
    metadata,
    Column("key_sha256", String, primary_key=True),
    Column("state", String, nullable=False),
    # The process and the try that answer the call.
    Column("owner", String, nullable=False),
    Column("try_id", String, nullable=False),
    Column("content_sha256", String),
    Column("status", Integer),
    Column("media_type", String),
    Column("body", LargeBinary),
    Column("created_at", UtcDateTime, nullable=False, index=True),
)

# When a worker last began a task that one worker does for all: see `jobs.periodic`.
periodic_tasks = Table(
    "periodic_tasks",
    metadata,
    Column("name", String, primary_key=True),
    Column("began_at", UtcDateTime, nullable=False),
)
