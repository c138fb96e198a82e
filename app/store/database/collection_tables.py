"""The tables of what people make from clips: collections, saved searches, the tree of labels."""

from __future__ import annotations

from sqlalchemy import BigInteger, Column, Float, ForeignKey, Index, Integer, String, Table

from app.store.database.columns import UtcDateTime, clip_key, json_column, metadata

collections = Table(
    "collections",
    metadata,
    Column("id", String, primary_key=True),
    Column("name", String, nullable=False, unique=True),
    Column("notes", String, nullable=False),
    Column("created_at", UtcDateTime, nullable=False, index=True),
    Column("changed_at", UtcDateTime, nullable=False),
)

# Clips, or parts of clips from `start` to `end` (seconds), in the order of `position`.
collection_items = Table(
    "collection_items",
    metadata,
    Column("id", String, primary_key=True),
    Column(
        "collection_id",
        String,
        ForeignKey("collections.id", ondelete="CASCADE"),
        nullable=False,
    ),
    clip_key(nullable=False, index=True),
    Column("position", Integer, nullable=False),
    Column("start", Float),
    Column("end", Float),
    Column("notes", String, nullable=False),
    Index(None, "collection_id", "position"),
)

saved_searches = Table(
    "saved_searches",
    metadata,
    Column("id", String, primary_key=True),
    Column("name", String, nullable=False, unique=True),
    json_column("query", nullable=False),
    # The clips that were hits when the search was last looked at, and the library's version then.
    json_column("seen", nullable=False),
    Column("seen_version", BigInteger, nullable=False),
    Column("seen_at", UtcDateTime),
    Column("created_at", UtcDateTime, nullable=False, index=True),
)

# What people changed in the tree of labels: the parent of a label, or that it has none.
label_parents = Table(
    "label_parents",
    metadata,
    Column("label", String, primary_key=True),
    Column("parent", String),
)
