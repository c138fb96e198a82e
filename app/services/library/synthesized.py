"""The mark of clips that Kinedex synthesized. All other clips are recordings of people."""

from __future__ import annotations

from app.store.clips.record import ClipRecord

SYNTHESIZED = "synthesized"
"""The `source` of a synthesized clip. Searches find it like any other clip, but no model learns
from it: a model that learns from the output of a model would confirm its own errors."""


def is_synthesized(clip: ClipRecord) -> bool:
    """Whether Kinedex synthesized the clip."""
    return clip.source == SYNTHESIZED
