"""Clips keep measures of their motion. Workers analyze old clips again, which fills them."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0015"
branch_labels = None
depends_on = None

MEASURES = ("travel", "speed", "energy", "tempo")


def upgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        for name in MEASURES:
            batch_op.add_column(sa.Column(name, sa.Float(), nullable=True))


def downgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        for name in MEASURES:
            batch_op.drop_column(name)
