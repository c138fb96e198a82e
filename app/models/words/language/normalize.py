"""Normalizes words: lower case, phrases joined by underscores."""

from __future__ import annotations

import re
from collections.abc import Iterable

_JOINERS = re.compile(r"[\s\-_]+")


def normalize_word(word: str) -> str:
    """`word` in lower case, hyphens and blanks as single underscores: "High-Kick" -> "high_kick".

    The result is empty if nothing is left.
    """
    return _JOINERS.sub("_", word.strip().casefold()).strip("_")


def normalize_words(words: Iterable[str]) -> tuple[str, ...]:
    """The distinct normalized words in their order, without empty ones."""
    return tuple(dict.fromkeys(filter(None, map(normalize_word, words))))
