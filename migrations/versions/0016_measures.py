"""Clips keep measures of their motion, and sources and licenses are counted.

Workers analyze old clips again, which fills the measures.
"""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None

MEASURES = ("travel", "speed", "energy", "tempo")
COUNTED = ("license", "source")


def upgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        for name in MEASURES:
            batch_op.add_column(sa.Column(name, sa.Float(), nullable=True))
        for name in COUNTED:
            batch_op.create_index(batch_op.f(f"ix_clips_{name}"), [name], unique=False)


def downgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        for name in COUNTED:
            batch_op.drop_index(batch_op.f(f"ix_clips_{name}"))
        for name in MEASURES:
            batch_op.drop_column(name)
