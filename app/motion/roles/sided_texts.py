"""Exchanges left and right in texts, for the names and the labels of a mirrored motion."""

from __future__ import annotations

import re
from collections.abc import Mapping

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


def with_case_of(text: str, replacements: Mapping[str, str]) -> str:
    """The replacement of a text, in upper case, in title case or in lower case, as the text is."""
    replacement = replacements[text.lower()]
    if text.isupper():
        return replacement.upper()
    return replacement.capitalize() if text[:1].isupper() else replacement
