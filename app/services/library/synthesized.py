"""How a clip that was synthesised is told from what people did."""

from __future__ import annotations

from app.store.clips.record import ClipRecord

SYNTHESIZED = "synthesized"
"""The `source` of such a clip. It is searched like any other, but no model learns from it: a
model of what models made would confirm itself."""


def is_synthesized(clip: ClipRecord) -> bool:
    """Whether a clip was made by us."""
    return clip.source == SYNTHESIZED
