"""The kind of a model is spelled `recognizer`, as everything else that users see."""

from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.execute("UPDATE models SET kind = 'recognizer' WHERE kind = 'recogniser'")


def downgrade() -> None:
    op.execute("UPDATE models SET kind = 'recogniser' WHERE kind = 'recognizer'")
