"""Exchanges left and right in texts, for the labels of a mirrored motion."""

from __future__ import annotations

import re
from dataclasses import replace

from app.motion.editing.mirrored_joints import with_case_of
from app.store.clips.record import ClipLabels

_OTHER = {
    "left": "right",
    "right": "left",
    "leftward": "rightward",
    "rightward": "leftward",
    "leftwards": "rightwards",
    "rightwards": "leftwards",
    "clockwise": "counterclockwise",
    "counterclockwise": "clockwise",
    "anticlockwise": "clockwise",
    "counter-clockwise": "clockwise",
    "anti-clockwise": "clockwise",
}
_SIDED = re.compile(
    r"(?<![A-Za-z])(" + "|".join(sorted(_OTHER, key=len, reverse=True)) + r")(?-i:(?![a-z]))",
    re.IGNORECASE,
)
"""Whole words, also in `left_leg`, `LeftLeg` and `left-handed`, and not in `upright`."""


def exchanged(text: str) -> str:
    """The text with left and right exchanged, and the turns clockwise and counterclockwise."""
    return _SIDED.sub(lambda found: with_case_of(found[0], _OTHER), text)


def exchanged_labels(labels: ClipLabels) -> ClipLabels:
    """Labels with left and right exchanged, but for the person, the license and the source."""
    return replace(
        labels,
        name=exchanged(labels.name),
        task=None if labels.task is None else exchanged(labels.task),
        words=tuple(dict.fromkeys(map(exchanged, labels.words))),
        captions=tuple(dict.fromkeys(map(exchanged, labels.captions))),
        metadata={
            key: exchanged(value) if isinstance(value, str) else value
            for key, value in labels.metadata.items()
        },
    )
