"""Adds pairs of low-dimensional motions that people compare, and their votes."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "study_pairs",
        sa.Column("id", sa.String(), nullable=False),
        sa.Column("clip_id", sa.String(), nullable=False),
        sa.Column("dimensions", sa.Integer(), nullable=False),
        sa.Column("keyposes", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("sequence", sa.String(), nullable=False),
        sa.Column("left_basis", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["clip_id"],
            ["clips.id"],
            name=op.f("fk_study_pairs_clip_id_clips"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_study_pairs")),
    )
    with op.batch_alter_table("study_pairs", schema=None) as batch_op:
        for column in ("clip_id", "sequence", "created_at"):
            batch_op.create_index(batch_op.f(f"ix_study_pairs_{column}"), [column], unique=False)
    op.create_table(
        "study_votes",
        sa.Column("id", sa.String(), nullable=False),
        sa.Column("pair_id", sa.String(), nullable=False),
        sa.Column("sequence", sa.String(), nullable=False),
        sa.Column("choice", sa.String(), nullable=False),
        sa.Column("voter_sha256", sa.String(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["pair_id"],
            ["study_pairs.id"],
            name=op.f("fk_study_votes_pair_id_study_pairs"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_study_votes")),
        sa.UniqueConstraint(
            "sequence", "voter_sha256", name=op.f("uq_study_votes_sequence_voter_sha256")
        ),
    )
    with op.batch_alter_table("study_votes", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_study_votes_pair_id"), ["pair_id"], unique=False)


def downgrade() -> None:
    op.drop_table("study_votes")
    op.drop_table("study_pairs")
