"""Adds the id of the library, which its folder of files holds too, and removals of files."""

from __future__ import annotations

import secrets

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("library", schema=None) as batch_op:
        batch_op.add_column(sa.Column("library_id", sa.String(), nullable=True))
    library = sa.table("library", sa.column("library_id", sa.String()))
    op.execute(library.update().values(library_id=f"library_{secrets.token_hex(10)}"))
    with op.batch_alter_table("library", schema=None) as batch_op:
        batch_op.alter_column("library_id", existing_type=sa.String(), nullable=False)
    op.create_table(
        "file_removals",
        sa.Column("sha256", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("sha256", name=op.f("pk_file_removals")),
    )


def downgrade() -> None:
    op.drop_table("file_removals")
    with op.batch_alter_table("library", schema=None) as batch_op:
        batch_op.drop_column("library_id")
