"""Filters: the conditions that a clip must meet before it is ranked.

The keys of a filter are `person task word license source` (a string, or an array: the clip has one
of its values), the same keys with the prefix `not_` (the clip has none of the values), and
`min_NAME max_NAME` for each measure, such as `min_duration` (seconds). `collection` is the id of a
collection, or an array of ids. `folder` and `not_folder`
name folders of the paths of files; the folders below them count too. `meta.KEY` and `not_meta.KEY`
are values of a key of the metadata, `meta.KEY.min` and `meta.KEY.max` numbers. `measure.NAME.min`
and `measure.NAME.max` are bounds of any measure (`measures.EVERY`). Both ends of a range
are included. `annotation` is a word of an annotation, or an array of words. `created_after` and
`created_before` are times in ISO 8601; the first is included.

A clip must meet all conditions. A clip without a label meets all `not_` conditions for this label;
a clip without a measure meets no condition on it. Conditions are combined in trees: `all_of`,
`any_of` and `none_of` are arrays of filters, and `where` is one filter.
"""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from app.errors import BadField
from app.kinedex_error import Place
from app.models.words.language.normalize import normalize_word
from app.store.clips.filter import ClipFilter, MeasureBound, MetadataCondition
from app.store.clips.measures import EVERY, MEASURES
from app.store.clips.metadata_values import as_text, from_cell
from app.store.clips.record import META

TREE_KEYS = ("all_of", "any_of", "none_of")
WHERE = "where"
MAX_DEPTH = 5
"""The most filters inside each other in a filter."""
MAX_FILTERS = 50
"""The most filters of a tree of filters."""
DATE_KEYS = ("created_after", "created_before")
ANNOTATION = "annotation"
LABEL_KEYS = ("person", "task", "word", "license", "source", "folder")
COLLECTION = "collection"
NOT = "not_"
NOT_KEYS = tuple(NOT + key for key in LABEL_KEYS)
MAX_LABELS = 100
"""Largest number of values of one key in a filter."""
MAX_LABEL_LENGTH = 300
"""Largest number of characters of a label; no clip has a longer one."""
RANGE_KEYS = tuple(f"{end}_{name}" for name in MEASURES for end in ("min", "max"))
NOT_META = NOT + META
MEASURE = "measure."
MEASURE_PATTERN = rf"^measure\.({'|'.join(EVERY)})\.(min|max)$"
"""The names of bounds of measures, as a regular expression."""
META_PATTERN = r"^(not_)?meta\."
"""The names of conditions on metadata, as a regular expression."""
MINIMUM, MAXIMUM = ".min", ".max"
MAX_CONDITIONS = 20
"""Largest number of keys of the metadata in a filter."""


def parse_filter(given: Mapping[str, Any] | None) -> ClipFilter:
    """Read a filter of a request.

    Raises BadField, with a location for each unknown key and for each bad value.
    """
    reader = _Reader()
    found = reader.read(given or {}, "filter", 0)
    if reader.places:
        raise BadField("The filter cannot be used.", places=reader.places)
    return found


class _Reader:
    """Reads a filter and the filters below it. places: what is wrong."""

    def __init__(self) -> None:
        self.places: list[Place] = []
        self._count = 0

    def read(self, given: Mapping[str, Any], location: str, depth: int) -> ClipFilter:
        """One filter. depth: of filters above it."""
        values: dict[str, Any] = {}
        conditions = _Conditions()
        bounds: dict[str, MeasureBound] = {}
        for key, value in given.items():
            place = f"{location}.{key}"
            try:
                if key.startswith(MEASURE):
                    _add_bound(bounds, key, value)
                elif is_open_key(key):
                    conditions.add(key, value)
                elif key == WHERE:
                    values["all_of"] = (
                        *values.get("all_of", ()),
                        *self._below([value], place, depth, names=[place]),
                    )
                elif key in TREE_KEYS:
                    values[key] = values.get(key, ()) + self._below(value, place, depth)
                else:
                    values[key] = _read(key, value)
            except ValueError as problem:
                self.places.append(Place(place, str(problem)))
        return ClipFilter(**values, metadata=conditions.all(), measured=tuple(bounds.values()))

    def _below(
        self, given: Any, location: str, depth: int, names: Sequence[str] | None = None
    ) -> tuple[ClipFilter, ...]:
        """Filters below a filter. names: their places, by default by their index."""
        if not isinstance(given, list | tuple) or not given:
            raise ValueError("must be an array of filters, and not an empty one")
        if not all(isinstance(one, Mapping) for one in given):
            raise ValueError("must be filters: objects")
        if depth >= MAX_DEPTH:
            raise ValueError(f"at most {MAX_DEPTH} filters may be inside each other")
        self._count += len(given)
        if self._count > MAX_FILTERS:
            raise ValueError(f"a tree has at most {MAX_FILTERS} filters")
        places = names or [f"{location}.{index}" for index in range(len(given))]
        return tuple(
            self.read(one, place, depth + 1) for one, place in zip(given, places, strict=True)
        )


def is_open_key(key: str) -> bool:
    """Whether a key of a filter is a condition on metadata, or a bound of a measure."""
    return key.startswith((META, NOT_META, MEASURE))


def as_filter(given: ClipFilter | Mapping[str, Any] | None) -> ClipFilter:
    """A parsed filter: a ClipFilter stays as it is, any other filter is parsed."""
    return given if isinstance(given, ClipFilter) else parse_filter(given)


def as_stored(key: str, value: str) -> str:
    """A label as it is stored: in NFC, without outer spaces; words are normalized."""
    stripped = unicodedata.normalize("NFC", value).strip()
    if key == "folder":
        return stripped.replace("\\", "/").strip("/")
    return normalize_word(stripped) if key == "word" else stripped


class _Conditions:
    """The conditions on metadata, one for each key and one for each negated key."""

    def __init__(self) -> None:
        self._by_key: dict[tuple[str, bool], MetadataCondition] = {}

    def add(self, name: str, value: Any) -> None:
        """Add the condition of one member of a filter. Raises ValueError."""
        is_negated = name.startswith(NOT)
        key = name.removeprefix(NOT).removeprefix(META)
        end = key[-len(MINIMUM) :]
        if not is_negated and end in (MINIMUM, MAXIMUM):
            key = key.removesuffix(end)
            changes: dict[str, Any] = {"minimum" if end == MINIMUM else "maximum": _number(value)}
        else:
            changes = {"texts": _texts(value)}
        if not key:
            raise ValueError("must name a key of the metadata")
        before = self._by_key.get((key, is_negated))
        before = before or MetadataCondition(_nfc(key), is_negated=is_negated)
        self._by_key[key, is_negated] = replace(before, **changes)
        if len(self._by_key) > MAX_CONDITIONS:
            raise ValueError(f"a filter has at most {MAX_CONDITIONS} keys of the metadata")

    def all(self) -> tuple[MetadataCondition, ...]:
        """All conditions."""
        return tuple(self._by_key.values())


def _add_bound(bounds: dict[str, MeasureBound], key: str, value: Any) -> None:
    """Add one bound of a measure. Raises ValueError."""
    name, _, end = key.removeprefix(MEASURE).rpartition(".")
    if name not in EVERY or f".{end}" not in (MINIMUM, MAXIMUM):
        raise ValueError(
            f"must be {MEASURE}NAME{MINIMUM} or {MEASURE}NAME{MAXIMUM}; the names are "
            + ", ".join(EVERY)
        )
    before = bounds.get(name, MeasureBound(name))
    if f".{end}" == MINIMUM:
        bounds[name] = replace(before, minimum=_number(value))
    else:
        bounds[name] = replace(before, maximum=_number(value))


def _nfc(text: str) -> str:
    return unicodedata.normalize("NFC", text).strip()


def _texts(value: Any) -> tuple[str, ...]:
    """The texts of the accepted values. "30.0" stands for itself and for the number 30."""
    values = list(value) if isinstance(value, list | tuple) else [value]
    if not values or not all(isinstance(one, str | int | float) for one in values):
        raise ValueError("must be a string, a number, a boolean, or an array of them")
    if len(values) > MAX_LABELS or any(len(str(one)) > MAX_LABEL_LENGTH for one in values):
        raise ValueError(
            f"must be at most {MAX_LABELS} values of at most {MAX_LABEL_LENGTH} characters"
        )
    return tuple(dict.fromkeys(text for one in values for text in _texts_of(one)))


def _texts_of(value: str | float) -> tuple[str, ...]:
    if isinstance(value, str):
        text = _nfc(value)
        return text, as_text(from_cell(text))
    try:
        return (as_text(value),)
    except (ValueError, OverflowError):  # not finite, or larger than a float
        raise ValueError("must be a finite number") from None


def _number(value: Any) -> float:
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError("must be a number")
    return number


def _date(value: Any) -> datetime | None:
    """A time; UTC without a zone. Raises ValueError."""
    if value is None:
        return None
    try:
        time = datetime.fromisoformat(value.strip())
        return time.replace(tzinfo=UTC) if time.tzinfo is None else time.astimezone(UTC)
    except (AttributeError, ValueError, OverflowError):
        raise ValueError("must be a time as 2026-03-01 or 2026-03-01T12:00:00Z") from None


def _read(key: str, value: Any) -> tuple[str, ...] | float | datetime | None:
    if key in (*LABEL_KEYS, *NOT_KEYS, COLLECTION):
        return _labels(key.removeprefix(NOT), value)
    if key == ANNOTATION:
        return _labels("word", value)
    if key in DATE_KEYS:
        return _date(value)
    if key in RANGE_KEYS:
        return _measure(value)
    others = (COLLECTION, ANNOTATION, *DATE_KEYS, *RANGE_KEYS, f"{META}KEY", *TREE_KEYS)
    keys = ", ".join((*LABEL_KEYS, *NOT_KEYS, *others))
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


def _measure(value: Any) -> float | None:
    if value is None:
        return None
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0:
        raise ValueError("must be a number, zero or more")
    return float(value)
