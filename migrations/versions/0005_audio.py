"""Adds to clips an audio recording, the time at which it begins, and a client's beats."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.add_column(sa.Column("audio_sha256", sa.String(), nullable=True))
        batch_op.add_column(sa.Column("audio_name", sa.String(), nullable=True))
        batch_op.add_column(sa.Column("audio_size", sa.BigInteger(), nullable=True))
        batch_op.add_column(sa.Column("audio_offset_override", sa.Float(), nullable=True))
        batch_op.add_column(sa.Column("tempo_override", sa.Float(), nullable=True))
        batch_op.add_column(sa.Column("beats_override", sa.JSON(none_as_null=True), nullable=True))
        batch_op.add_column(sa.Column("audio_offset", sa.Float(), nullable=True))
        batch_op.create_index(batch_op.f("ix_clips_audio_sha256"), ["audio_sha256"])


def downgrade() -> None:
    with op.batch_alter_table("clips", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_clips_audio_sha256"))
        for name in (
            "audio_offset",
            "beats_override",
            "tempo_override",
            "audio_offset_override",
            "audio_size",
            "audio_name",
            "audio_sha256",
        ):
            batch_op.drop_column(name)
