"""Filters: the conditions that a clip must meet before it is ranked.

The keys of a filter are `person task word license source` (a string, or an array: the clip has one
of its values), the same keys with the prefix `not_` (the clip has none of the values), and
`min_duration max_duration` (seconds). A clip must meet all conditions. A clip without a label meets
all `not_` conditions for this label.
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
NOT_KEYS = tuple(NOT + key for key in LABEL_KEYS)
MAX_LABELS = 100
"""Largest number of values of one key in a filter."""
MAX_LABEL_LENGTH = 300
"""Largest number of characters of a label; no clip has a longer one."""
DURATION_KEYS = ("min_duration", "max_duration")


def parse_filter(given: Mapping[str, Any] | None) -> ClipFilter:
    """Read a filter of a request.

    Raises BadField, with a location for each unknown key and for each bad value.
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
    """A parsed filter: a ClipFilter stays as it is, any other filter is parsed."""
    return given if isinstance(given, ClipFilter) else parse_filter(given)


def as_stored(key: str, value: str) -> str:
    """A label as it is stored: in NFC, without outer spaces; words are normalized."""
    stripped = unicodedata.normalize("NFC", value).strip()
    return normalize_word(stripped) if key == "word" else stripped


def _read(key: str, value: Any) -> tuple[str, ...] | float | None:
    if key in LABEL_KEYS or key in NOT_KEYS:
        return _labels(key.removeprefix(NOT), value)
    if key in DURATION_KEYS:
        return _seconds(value)
    keys = ", ".join((*LABEL_KEYS, *NOT_KEYS, *DURATION_KEYS))
    raise ValueError(f"is not a key of a filter; the keys are {keys}")


def _labels(key: str, value: Any) -> tuple[str, ...]:
    if value is None:
        return ()
    values = [value] if isinstance(value, str) else value
    if not isinstance(values, list | tuple) or not all(isinstance(v, str) for v in values):
        raise ValueError("must be a string, or an array of strings")
    if not values:
        raise ValueError("an empty array has no meaning; leave the key out")
    if len(values) > MAX_LABELS or any(len(v) > MAX_LABEL_LENGTH for v in values):
        raise ValueError(
            f"must be at most {MAX_LABELS} strings of at most {MAX_LABEL_LENGTH} characters"
        )
    return tuple(as_stored(key, v) for v in values)


def _seconds(value: Any) -> float | None:
    if value is None:
        return None
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0:
        raise ValueError("must be a number of seconds, zero or more")
    return float(value)
