"""The kinds of hypotheses about a clip; see app.models.recognition.hypotheses."""

from __future__ import annotations

from enum import IntEnum


class Kind(IntEnum):
    """Which part of a clip is new according to a hypothesis."""

    SEEN = 0
    UNSEEN = 1
    NEW_PERSON = 2
    NEW_TASK = 3
    NEW_BOTH = 4


class Disturbed(IntEnum):
    """What may have happened to a clip according to a hypothesis."""

    NOT = 0
    LIGHTLY = 1
    """Noise, or another speed."""
    CUT = 2
    """Any of the copies' disturbances, which include a lost start and end."""
    MIRRORED = 3
    """Left and right are exchanged, in the motion and in its task."""
