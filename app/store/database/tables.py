"""The tables. All types are portable; constraints have names, so that migrations can find them."""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    String,
    Table,
    UniqueConstraint,
    false,
)

from app.analysis.quality.definitions import NAMES
from app.store.database.columns import UtcDateTime, clip_key, json_column, metadata

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
    # The name, the path, the texts of the metadata and the captions, folded, one a line: `rows`.
    Column("searched", String, nullable=False, server_default=""),
    # The labels and hints that came with the file last: see `ClipRecord.imported`.
    json_column("imported"),
    Column("state", String, nullable=False, index=True),
    Column("format", String),
    Column("person", String, index=True),
    Column("task", String, index=True),
    Column("license", String, index=True),
    Column("source", String, index=True),
    Column("frame_rate_override", Float),
    Column("metres_per_unit_override", Float),
    Column("up_axis_override", String),
    json_column("roles_override"),
    Column("stack_override", String),
    Column("audio_offset_override", Float),
    Column("tempo_override", Float),
    json_column("beats_override"),
    Column("audio_offset", Float),
    Column("start_offset", Float),
    Column("frames", Integer),
    Column("frame_rate", Float),
    Column("declared_frame_rate", Float),
    Column("duration", Float, index=True),
    Column("joints", Integer),
    Column("travel", Float),
    Column("speed", Float),
    Column("energy", Float),
    Column("tempo", Float),
    Column("metres_per_unit", Float),
    json_column("roles"),
    json_column("missing_roles"),
    json_column("warnings"),
    json_column("error"),
    Column("analysis_version", Integer),
    Column("reanalysis", String, index=True),
    Column("is_changed", Boolean, nullable=False, server_default=false()),
    # The clip of which this one is an edited copy: see `ClipOrigin`. No foreign key: the copy
    # remains, and says that the original was deleted.
    Column("origin_clip_id", String, index=True),
    json_column("origin_steps"),
    Column("origin_deleted", Boolean, nullable=False, server_default=false()),
    Column("changed_version", BigInteger, nullable=False, index=True),
    Column("created_at", UtcDateTime, nullable=False, index=True),
)

clip_words = Table(
    "clip_words",
    metadata,
    clip_key(primary_key=True),
    Column("word", String, primary_key=True, index=True),
    Column("position", Integer, nullable=False),
)

clip_captions = Table(
    "clip_captions",
    metadata,
    clip_key(primary_key=True),
    Column("position", Integer, primary_key=True, autoincrement=False),
    Column("text", String, nullable=False),
)

clip_metadata = Table(
    "clip_metadata",
    metadata,
    clip_key(primary_key=True),
    Column("key", String, primary_key=True),
    Column("kind", String, nullable=False),
    Column("text", String, nullable=False),
    # Only of a value that is a number.
    Column("number", Float),
    # With all columns that filters and counts read, so that they read no rows of the table.
    Index(None, "key", "text", "kind", "clip_id"),
    Index(None, "key", "number", "kind", "clip_id"),
)

# Measures of quality and movement, NULL for those that a clip lacks.
clip_measures = Table(
    "clip_measures",
    metadata,
    clip_key(primary_key=True),
    *(Column(name, Float) for name in NAMES),
)

# Clips that show the same take or almost the same motion: see `store.curation.pairs`.
duplicate_pairs = Table(
    "duplicate_pairs",
    metadata,
    clip_key(primary_key=True),
    Column(
        "other_id", String, ForeignKey("clips.id", ondelete="CASCADE"), primary_key=True, index=True
    ),
    Column("kind", String, nullable=False),
    Column("distance", Float, nullable=False),
    Column("offset", Float, nullable=False),
    Column("shift", Float, nullable=False),
    Column("seconds", Float, nullable=False),
    Column("is_mirrored", Boolean, nullable=False),
    Column("dismissed_at", UtcDateTime),
)

# The library version of each clip when it was compared with the others.
duplicate_checks = Table(
    "duplicate_checks",
    metadata,
    clip_key(primary_key=True),
    Column("version", BigInteger, nullable=False),
)

# What a person has said is right although it looks wrong, for one value of a label.
dismissed_outliers = Table(
    "dismissed_outliers",
    metadata,
    clip_key(primary_key=True),
    Column("reason", String, primary_key=True),
    Column("label", String, nullable=False),
    Column("dismissed_at", UtcDateTime, nullable=False),
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
    clip_key(primary_key=True),
    Column("name", String, primary_key=True),
    Column("version", Integer, nullable=False),
    Column("dtype", String, nullable=False),
    Column("shape", String, nullable=False),
    Column("data", LargeBinary, nullable=False),
)

keypose_annotations = Table(
    "keypose_annotations",
    metadata,
    clip_key(primary_key=True),
    json_column("times", nullable=False),
    Column("annotated_at", UtcDateTime, nullable=False),
)

# Spans of clips with words: what people and models say about parts.
clip_annotations = Table(
    "clip_annotations",
    metadata,
    Column("id", String, primary_key=True),
    clip_key(nullable=False, index=True),
    Column("start_s", Float, nullable=False),
    Column("end_s", Float, nullable=False),
    json_column("words", nullable=False),
    Column("person", String, index=True),
    Column("text", String),
    Column("said_by", String),
    Column("origin", String, nullable=False),
    Column("probability", Float),
    Column("changed_at", UtcDateTime, nullable=False),
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
    json_column("payload", nullable=False),
    Column("progress", Float, nullable=False),
    Column("detail", String),
    json_column("result"),
    json_column("error"),
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
    json_column("problem"),
    # The labels and hints that differed from those of the stored clip: see `record.Difference`.
    json_column("differences"),
)

models = Table(
    "models",
    metadata,
    Column("id", String, primary_key=True),
    Column("kind", String, nullable=False),
    Column("version", Integer, nullable=False),
    Column("library_version", BigInteger, nullable=False),
    Column("library_size", Integer, nullable=False),
    json_column("meta", nullable=False),
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

# Results of evaluations. They do not change when the library does.
evaluations = Table(
    "evaluations",
    metadata,
    Column("id", String, primary_key=True),
    Column("kind", String, nullable=False),
    json_column("options", nullable=False),
    Column("library_version", BigInteger, nullable=False),
    Column("library_size", Integer, nullable=False),
    Column("seconds", Float, nullable=False),
    json_column("figures", nullable=False),
    json_column("document", nullable=False),
    Column("created_at", UtcDateTime, nullable=False, index=True),
    Index(None, "kind", "created_at"),
)

study_pairs = Table(
    "study_pairs",
    metadata,
    Column("id", String, primary_key=True),
    clip_key(nullable=False, index=True),
    Column("dimensions", Integer, nullable=False),
    # Stored with the pair, because a pair that has votes must not change.
    json_column("keyposes", nullable=False),
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
