"""What narrows a search before anything is ranked (DESIGN 8, "Search input").

A filter names any of `person task word license source` (a string, or an array meaning any
of), the same with `not_` before them (none of), and `min_duration max_duration` (seconds). All
that are named must hold; a clip without a label has none of the refused ones.
"""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Mapping
from typing import Any

from app.errors import BadField, Place
from app.models.words.language.normalize import normalize_word
from app.store.clips.filter import ClipFilter

LABEL_KEYS = ("person", "task", "word", "license", "source")
NOT = "not_"
REFUSAL_KEYS = tuple(NOT + key for key in LABEL_KEYS)
MOST_LABELS = 100
"""Labels of one kind that a filter names."""
LONGEST_LABEL = 300
"""Characters; no clip carries a longer one."""
DURATION_KEYS = ("min_duration", "max_duration")


def parse_filter(given: Mapping[str, Any] | None) -> ClipFilter:
    """Read a filter as a client sends it.

    Raises BadField naming each unknown key and each value of a wrong kind.
    """
    places: list[Place] = []
    values: dict[str, Any] = {}
    for key, value in (given or {}).items():
        try:
            values[key] = _read(key, value)
        except ValueError as problem:
            places.append(Place(f"filter.{key}", str(problem)))
    if places:
        raise BadField("The filter cannot be used.", places=places)
    return ClipFilter(**values)


def as_filter(given: ClipFilter | Mapping[str, Any] | None) -> ClipFilter:
    """A filter that was read already as it is, any other by `parse_filter`."""
    return given if isinstance(given, ClipFilter) else parse_filter(given)


def as_kept(key: str, value: str) -> str:
    """A label as clips keep it: composed (NFC), no space around; a word in lower case, joined."""
    tidy = unicodedata.normalize("NFC", value).strip()
    return normalize_word(tidy) if key == "word" else tidy


def _read(key: str, value: Any) -> tuple[str, ...] | float | None:
    if key in LABEL_KEYS or key in REFUSAL_KEYS:
        return _labels(key.removeprefix(NOT), value)
    if key in DURATION_KEYS:
        return _seconds(value)
    known = ", ".join((*LABEL_KEYS, *REFUSAL_KEYS, *DURATION_KEYS))
    raise ValueError(f"there is no such filter; known are {known}")


def _labels(key: str, value: Any) -> tuple[str, ...]:
    if value is None:
        return ()
    values = [value] if isinstance(value, str) else value
    if not isinstance(values, list | tuple) or not all(isinstance(v, str) for v in values):
        raise ValueError("must be a string, or an array of strings")
    if not values:
        raise ValueError("an empty array has no meaning; leave the key out")
    if len(values) > MOST_LABELS or any(len(v) > LONGEST_LABEL for v in values):
        raise ValueError(f"must be at most {MOST_LABELS}, of at most {LONGEST_LABEL} characters")
    return tuple(as_kept(key, v) for v in values)


def _seconds(value: Any) -> float | None:
    if value is None:
        return None
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0:
        raise ValueError("must be a number of seconds, zero or more")
    return float(value)
