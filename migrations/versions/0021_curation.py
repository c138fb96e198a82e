"""Measures of quality and movement, near-duplicates, and outliers that a person has accepted.

Workers analyze old clips again, which fills the measures.
"""

import sqlalchemy as sa
from alembic import op

revision = "0021"
down_revision = "0020"
branch_labels = None
depends_on = None

MEASURES = (
    *("foot_skate", "ground_penetration", "floating", "jitter", "joint_limits", "self_contact"),
    *("airborne_time", "unsupported_time", "turn", "net_turn", "dominance"),
    *("cyclicity", "cycle_time", "loop_gap", "loop_start", "loop_end", "start_speed", "end_speed"),
    *("range_trunk", "range_neck", "range_left_shoulder", "range_right_shoulder"),
    *("range_left_elbow", "range_right_elbow", "range_left_hip", "range_right_hip"),
    *("range_left_knee", "range_right_knee"),
)
TABLES = ("dismissed_outliers", "duplicate_checks", "duplicate_pairs", "clip_measures")


def _clip_key(table: str, name: str = "clip_id") -> tuple[sa.Column, sa.ForeignKeyConstraint]:
    constraint = sa.ForeignKeyConstraint(
        [name], ["clips.id"], name=op.f(f"fk_{table}_{name}_clips"), ondelete="CASCADE"
    )
    return sa.Column(name, sa.String(), nullable=False), constraint


def upgrade() -> None:
    op.create_table(
        "clip_measures",
        *_clip_key("clip_measures"),
        *(sa.Column(name, sa.Float(), nullable=True) for name in MEASURES),
        sa.PrimaryKeyConstraint("clip_id", name=op.f("pk_clip_measures")),
    )
    op.create_table(
        "duplicate_pairs",
        *_clip_key("duplicate_pairs"),
        *_clip_key("duplicate_pairs", "other_id"),
        sa.Column("kind", sa.String(), nullable=False),
        *(
            sa.Column(name, sa.Float(), nullable=False)
            for name in ("distance", "offset", "shift", "seconds")
        ),
        sa.Column("is_mirrored", sa.Boolean(), nullable=False),
        sa.Column("dismissed_at", sa.DateTime(timezone=True), nullable=True),
        sa.PrimaryKeyConstraint("clip_id", "other_id", name=op.f("pk_duplicate_pairs")),
    )
    op.create_index(op.f("ix_duplicate_pairs_other_id"), "duplicate_pairs", ["other_id"])
    op.create_table(
        "duplicate_checks",
        *_clip_key("duplicate_checks"),
        sa.Column("version", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("clip_id", name=op.f("pk_duplicate_checks")),
    )
    op.create_table(
        "dismissed_outliers",
        *_clip_key("dismissed_outliers"),
        sa.Column("reason", sa.String(), nullable=False),
        sa.Column("label", sa.String(), nullable=False),
        sa.Column("dismissed_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("clip_id", "reason", name=op.f("pk_dismissed_outliers")),
    )


def downgrade() -> None:
    for name in TABLES:
        op.drop_table(name)
