"""The tables. All types are portable; constraints have names, so that migrations can find them."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    DateTime,
    Dialect,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    UniqueConstraint,
    false,
)
from sqlalchemy.types import TypeDecorator

metadata = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "ck": "ck_%(table_name)s_%(constraint_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s_%(referred_table_name)s",
        "pk": "pk_%(table_name)s",
    }
)


class UtcDateTime(TypeDecorator[datetime]):
    """A time in UTC. In Python it always has a time zone, which SQLite does not store."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(
        self,
        value: datetime | None,
        dialect: Dialect,  # noqa: ARG002 - SQLAlchemy's signature
    ) -> datetime | None:
        """The value to store: in UTC."""
        return None if value is None else value.astimezone(UTC)

    def process_result_value(
        self,
        value: datetime | None,
        dialect: Dialect,  # noqa: ARG002 - SQLAlchemy's signature
    ) -> datetime | None:
        """The stored value with the time zone UTC."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


def _json(name: str, **options: Any) -> Column[Any]:
    return Column(name, JSON(none_as_null=True), **options)


def _clip_key(**options: Any) -> Column[Any]:
    return Column("clip_id", String, ForeignKey("clips.id", ondelete="CASCADE"), **options)


library = Table(
    "library",
    metadata,
    Column("id", Integer, primary_key=True, autoincrement=False),
    Column("version", BigInteger, nullable=False),
    # The folder of files holds the same id: see `identity`.
    Column("library_id", String, nullable=False),
)

# Files that no row needs since a committed change, and that must still be removed.
file_removals = Table("file_removals", metadata, Column("sha256", String, primary_key=True))

clips = Table(
    "clips",
    metadata,
    Column("id", String, primary_key=True),
    Column("content_key", String, nullable=False, unique=True),
    Column("sha256", String, nullable=False, index=True),
    Column("file_name", String, nullable=False),
    Column("file_size", BigInteger, nullable=False),
    Column("skeleton_sha256", String, index=True),
    Column("audio_sha256", String, index=True),
    Column("audio_name", String),
    Column("audio_size", BigInteger),
    Column("name", String, nullable=False),
    Column("name_folded", String, nullable=False, index=True),
    Column("path", String),
    # The path without its last part; "" for a file that was in no folder.
    Column("folder", String, index=True),
    # The name, the path and the texts of the metadata, folded, one a line: see `rows`.
    Column("searched", String, nullable=False, server_default=""),
    # The labels and hints that came with the file last: see `ClipRecord.imported`.
    _json("imported"),
    Column("state", String, nullable=False, index=True),
    Column("format", String),
    Column("person", String, index=True),
    Column("task", String, index=True),
    Column("license", String),
    Column("source", String),
    Column("frame_rate_override", Float),
    Column("metres_per_unit_override", Float),
    Column("up_axis_override", String),
    _json("roles_override"),
    Column("stack_override", String),
    Column("audio_offset_override", Float),
    Column("tempo_override", Float),
    _json("beats_override"),
    Column("audio_offset", Float),
    Column("start_offset", Float),
    Column("frames", Integer),
    Column("frame_rate", Float),
    Column("declared_frame_rate", Float),
    Column("duration", Float, index=True),
    Column("joints", Integer),
    Column("metres_per_unit", Float),
    _json("roles"),
    _json("missing_roles"),
    _json("warnings"),
    _json("error"),
    Column("analysis_version", Integer),
    Column("reanalysis", String, index=True),
    Column("is_changed", Boolean, nullable=False, server_default=false()),
    Column("changed_version", BigInteger, nullable=False, index=True),
    Column("created_at", UtcDateTime, nullable=False, index=True),
)

clip_words = Table(
    "clip_words",
    metadata,
    _clip_key(primary_key=True),
    Column("word", String, primary_key=True, index=True),
    Column("position", Integer, nullable=False),
)

clip_metadata = Table(
    "clip_metadata",
    metadata,
    _clip_key(primary_key=True),
    Column("key", String, primary_key=True),
    Column("kind", String, nullable=False),
    Column("text", String, nullable=False),
    # Only of a value that is a number.
    Column("number", Float),
    # With all columns that filters and counts read, so that they read no rows of the table.
    Index(None, "key", "text", "kind", "clip_id"),
    Index(None, "key", "number", "kind", "clip_id"),
)

tombstones = Table(
    "tombstones",
    metadata,
    Column("clip_id", String, primary_key=True),
    Column("version", BigInteger, nullable=False, index=True),
)

clip_arrays = Table(
    "clip_arrays",
    metadata,
    _clip_key(primary_key=True),
    Column("name", String, primary_key=True),
    Column("version", Integer, nullable=False),
    Column("dtype", String, nullable=False),
    Column("shape", String, nullable=False),
    Column("data", LargeBinary, nullable=False),
)

keypose_annotations = Table(
    "keypose_annotations",
    metadata,
    _clip_key(primary_key=True),
    _json("times", nullable=False),
    Column("annotated_at", UtcDateTime, nullable=False),
)

jobs = Table(
    "jobs",
    metadata,
    Column("id", String, primary_key=True),
    Column("kind", String, nullable=False),
    Column("state", String, nullable=False),
    Column("priority", Integer, nullable=False),
    Column("dedupe_key", String, unique=True),
    # No foreign key: the job remains as a record after its clip is deleted.
    Column("clip_id", String, index=True),
    Column("file_sha256", String, index=True),
    _json("payload", nullable=False),
    Column("progress", Float, nullable=False),
    Column("detail", String),
    _json("result"),
    _json("error"),
    Column("attempts", Integer, nullable=False),
    Column("max_attempts", Integer, nullable=False),
    Column("owner", String),
    # Heartbeats since the claim. While the number grows, other workers know that the owner lives.
    Column("beats", Integer, nullable=False, server_default="0"),
    # Failed attempts by cause: see `jobs.record.ClaimedJob`.
    Column("failures", Integer, nullable=False, server_default="0"),
    Column("kills", Integer, nullable=False, server_default="0"),
    Column("worker_deaths", Integer, nullable=False, server_default="0"),
    Column("not_before", UtcDateTime),
    Column("cancel_requested", Boolean, nullable=False),
    Column("created_at", UtcDateTime, nullable=False, index=True),
    Column("started_at", UtcDateTime),
    Column("finished_at", UtcDateTime, index=True),
    Index(None, "state", "priority", "created_at"),
    # The metrics count the jobs of each kind and state, and read nothing but this index.
    Index(None, "state", "kind", "created_at"),
)

import_entries = Table(
    "import_entries",
    metadata,
    Column("job_id", String, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True),
    Column("path", String, primary_key=True),
    Column("outcome", String, nullable=False),
    Column("clip_id", String, ForeignKey("clips.id", ondelete="SET NULL"), index=True),
    _json("problem"),
    # The labels and hints that differed from those of the stored clip: see `record.Difference`.
    _json("differences"),
)

models = Table(
    "models",
    metadata,
    Column("id", String, primary_key=True),
    Column("kind", String, nullable=False),
    Column("version", Integer, nullable=False),
    Column("library_version", BigInteger, nullable=False),
    Column("library_size", Integer, nullable=False),
    _json("meta", nullable=False),
    Column("created_at", UtcDateTime, nullable=False),
    UniqueConstraint("kind", "version"),
)

model_arrays = Table(
    "model_arrays",
    metadata,
    Column("model_id", String, ForeignKey("models.id", ondelete="CASCADE"), primary_key=True),
    Column("name", String, primary_key=True),
    Column("dtype", String, nullable=False),
    Column("shape", String, nullable=False),
    Column("data", LargeBinary, nullable=False),
)

api_keys = Table(
    "api_keys",
    metadata,
    Column("id", String, primary_key=True),
    Column("name", String, nullable=False),
    Column("role", String, nullable=False),
    Column("secret_sha256", String, nullable=False),
    Column("created_at", UtcDateTime, nullable=False),
    Column("revoked_at", UtcDateTime),
)

study_pairs = Table(
    "study_pairs",
    metadata,
    Column("id", String, primary_key=True),
    _clip_key(nullable=False, index=True),
    Column("dimensions", Integer, nullable=False),
    # Stored with the pair, because a pair that has votes must not change.
    _json("keyposes", nullable=False),
    Column("sequence", String, nullable=False, index=True),
    Column("left_basis", String, nullable=False),
    Column("created_at", UtcDateTime, nullable=False, index=True),
)

study_votes = Table(
    "study_votes",
    metadata,
    Column("id", String, primary_key=True),
    Column(
        "pair_id",
        String,
        ForeignKey("study_pairs.id", ondelete="CASCADE"),
        nullable=False,
        index=True,
    ),
    Column("sequence", String, nullable=False),
    Column("choice", String, nullable=False),
    Column("voter_sha256", String),
    Column("created_at", UtcDateTime, nullable=False),
    UniqueConstraint("sequence", "voter_sha256"),
)

# How long the stages of analyses took since the library was made. The sums never fall.
stage_times = Table(
    "stage_times",
    metadata,
    Column("stage", String, primary_key=True),
    Column("seconds", Float, nullable=False),
    Column("count", BigInteger, nullable=False),
)

webhooks = Table(
    "webhooks",
    metadata,
    Column("id", String, primary_key=True),
    Column("url", String, nullable=False),
    Column("secret", String, nullable=False),
    _json("events", nullable=False),
    Column("is_enabled", Boolean, nullable=False, index=True),
    # Failures without a success in between, and when the next delivery is due.
    Column("failures", Integer, nullable=False),
    Column("not_before", UtcDateTime),
    _json("last_delivery"),
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
