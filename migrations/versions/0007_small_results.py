"""Removes the list of files from the results of imports; adds an index of the end of jobs."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

MAX_PATH = 500
_ENTRIES = sa.table("import_entries", sa.column("job_id", sa.String), sa.column("path", sa.String))


# The database does this, because a result may be too large for Python objects.
_SQLITE = """
UPDATE jobs SET result = json_set(json_remove(result, '$.files'), '$.absent', 0)
WHERE kind = 'import' AND result IS NOT NULL
"""
_POSTGRESQL = """
UPDATE jobs SET result = (CAST(result AS jsonb) - 'files') || jsonb_build_object('absent', 0)
WHERE kind = 'import' AND result IS NOT NULL
"""


def upgrade() -> None:
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_jobs_finished_at"), ["finished_at"])
    is_sqlite = op.get_bind().dialect.name == "sqlite"
    op.execute(_SQLITE if is_sqlite else _POSTGRESQL)
    _shorten_paths()


def _shorten_paths() -> None:
    """Shortens paths that do not fit into the cursor of a page. Earlier versions allowed them."""
    connection = op.get_bind()
    long = sa.select(_ENTRIES).where(sa.func.length(_ENTRIES.c.path) > MAX_PATH)
    for number, (job_id, path) in enumerate(connection.execute(long).all()):
        this = sa.and_(_ENTRIES.c.job_id == job_id, _ENTRIES.c.path == path)
        short = f"{path[:230]}…{path[-230:]} ({number})"
        connection.execute(sa.update(_ENTRIES).where(this).values(path=short))


def downgrade() -> None:
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_jobs_finished_at"))
