"""Adds the path and the metadata of clips, and the labels that came with a file last.

Files of imports get their differences from the stored clips. What imports called `exists` is now
`unchanged`.
"""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

_ENTRIES = sa.table("import_entries", sa.column("outcome", sa.String()))
_RENAMED = {"ready": "new", "exists": "unchanged"}
"""Members of the result of an import, and their new names."""
_ADDED = ("updated", "conflicting", "skipped")


def upgrade() -> None:
    op.create_table(
        "clip_metadata",
        sa.Column("clip_id", sa.String(), nullable=False),
        sa.Column("key", sa.String(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("text", sa.String(), nullable=False),
        sa.Column("number", sa.Float(), nullable=True),
        sa.ForeignKeyConstraint(
            ["clip_id"],
            ["clips.id"],
            name=op.f("fk_clip_metadata_clip_id_clips"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("clip_id", "key", name=op.f("pk_clip_metadata")),
    )
    for column in ("text", "number"):
        name = op.f(f"ix_clip_metadata_key_{column}_kind_clip_id")
        op.create_index(name, "clip_metadata", ["key", column, "kind", "clip_id"])
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.add_column(sa.Column("path", sa.String(), nullable=True))
        batch_op.add_column(sa.Column("folder", sa.String(), nullable=True))
        batch_op.add_column(sa.Column("searched", sa.String(), nullable=False, server_default=""))
        batch_op.add_column(sa.Column("imported", sa.JSON(none_as_null=True), nullable=True))
        batch_op.create_index(batch_op.f("ix_clips_folder"), ["folder"])
    op.execute("UPDATE clips SET searched = name_folded")
    with op.batch_alter_table("import_entries", schema=None) as batch_op:
        batch_op.add_column(sa.Column("differences", sa.JSON(none_as_null=True), nullable=True))
    _set_outcomes({"exists": "unchanged"})
    _rename_members(_RENAMED, dict.fromkeys(_ADDED, 0))


def downgrade() -> None:
    _rename_members({new: old for old, new in _RENAMED.items()}, {})
    _set_outcomes(
        {"unchanged": "exists", "updated": "exists", "conflicting": "exists", "skipped": "failed"}
    )
    with op.batch_alter_table("import_entries", schema=None) as batch_op:
        batch_op.drop_column("differences")
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_clips_folder"))
        for name in ("imported", "searched", "folder", "path"):
            batch_op.drop_column(name)
    op.drop_table("clip_metadata")


def _set_outcomes(new_by_old: dict[str, str]) -> None:
    for old, new in new_by_old.items():
        renamed = sa.update(_ENTRIES).where(_ENTRIES.c.outcome == old).values(outcome=new)
        op.execute(renamed)


def _rename_members(new_by_old: dict[str, str], added: dict[str, int]) -> None:
    """Rename members of the results of imports, and add others that are not there."""
    jobs = sa.table(
        "jobs", sa.column("id"), sa.column("kind"), sa.column("result", sa.JSON(none_as_null=True))
    )
    connection = op.get_bind()
    query = sa.select(jobs.c.id, jobs.c.result).where(jobs.c.kind == "import")
    for job_id, result in connection.execute(query).all():
        if result and new_by_old.keys() <= result.keys():
            renamed = {new_by_old.get(name, name): value for name, value in result.items()}
            change = sa.update(jobs).where(jobs.c.id == job_id)
            connection.execute(change.values(result=renamed | added))
