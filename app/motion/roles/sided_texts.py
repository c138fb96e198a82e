"""Exchanges left and right in texts, for the names and the labels of a mirrored motion."""

from __future__ import annotations

import re

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
    return _SIDED.sub(lambda found: _with_case_of(found[0]), text)


def _with_case_of(word: str) -> str:
    other = _OTHER[word.lower()]
    if word.isupper():
        return other.upper()
    return other.capitalize() if word[0].isupper() else other
