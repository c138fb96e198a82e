"""Replaces the end time of leases by counters of heartbeats and of failures by their cause.

It also adds the state of another analysis of a ready clip (`reanalysis`), and whether a client
changed the input of the analysis (`is_changed`).
"""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

_COUNTERS = ("beats", "failures", "kills", "worker_deaths")


def upgrade() -> None:
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        for name in _COUNTERS:
            batch_op.add_column(sa.Column(name, sa.Integer(), nullable=False, server_default="0"))
        batch_op.drop_column("lease_until")
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.add_column(sa.Column("reanalysis", sa.String(), nullable=True))
        batch_op.add_column(
            sa.Column("is_changed", sa.Boolean(), nullable=False, server_default=sa.false())
        )
        batch_op.create_index(batch_op.f("ix_clips_reanalysis"), ["reanalysis"])


def downgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_clips_reanalysis"))
        batch_op.drop_column("is_changed")
        batch_op.drop_column("reanalysis")
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("lease_until", sa.DateTime(timezone=True), nullable=True))
        for name in _COUNTERS:
            batch_op.drop_column(name)
