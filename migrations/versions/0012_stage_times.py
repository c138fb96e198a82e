"""Adds the time that the stages of analyses took, and an index from which jobs are counted."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "stage_times",
        sa.Column("stage", sa.String(), nullable=False),
        sa.Column("seconds", sa.Float(), nullable=False),
        sa.Column("count", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("stage", name=op.f("pk_stage_times")),
    )
    op.create_index(op.f("ix_jobs_state_kind_created_at"), "jobs", ["state", "kind", "created_at"])


def downgrade() -> None:
    op.drop_index(op.f("ix_jobs_state_kind_created_at"), table_name="jobs")
    op.drop_table("stage_times")
