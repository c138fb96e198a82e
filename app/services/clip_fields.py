"""The labels and hints of a clip, by the names that clients use, each with its check.

A form, a JSON body, a manifest and the command line all bring their values here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from app.services import fields
from app.services.fields import bad_field
from app.store.clips.metadata_values import MetadataValue, tidy_number
from app.store.clips.record import META, AnalysisHints, ClipChanges, ClipLabels

MAX_META_KEYS = 50
"""Keys of the metadata of one clip."""
MAX_META_KEY = 60
"""Characters of a key of the metadata."""
NOT_IN_KEYS = ".={}"
"""Characters that no key has: a filter uses the dot, a command the equals sign, and a pattern of
paths the braces."""


def metadata(value: Mapping[str, Any] | None) -> dict[str, MetadataValue | None] | None:
    """Metadata: checked keys, each with a string, a number, a boolean or None (no value)."""
    if value is None:
        return None
    if not isinstance(value, Mapping):
        raise bad_field("metadata", "must be an object: values by key")
    if len(value) > MAX_META_KEYS:
        raise bad_field("metadata", f"must not have more than {MAX_META_KEYS} keys")
    return {metadata_key(key): _metadata_value(key, one) for key, one in value.items()}


def metadata_key(key: str) -> str:
    """A key of the metadata in Unicode's NFC form, without surrounding spaces."""
    tidy = fields.text("metadata", key) or ""
    if not tidy or len(tidy) > MAX_META_KEY:
        raise bad_field("metadata", f"a key must have 1 to {MAX_META_KEY} characters: {tidy!r}")
    if any(c in tidy for c in NOT_IN_KEYS):
        raise bad_field(META + tidy, f"a key must not hold any of {' '.join(NOT_IN_KEYS)}")
    if tidy.casefold() in RESERVED_KEYS:
        raise bad_field(META + tidy, "is the name of a field of a clip, so it cannot be a key")
    return tidy


def _metadata_value(key: str, value: Any) -> MetadataValue | None:
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        number = fields.parsed_number(META + key, value)
        return None if number is None else tidy_number(number)
    return fields.text(META + key, value)


Check = Callable[[Any], Any]

LABELS: Mapping[str, Check] = {
    "name": partial(fields.text, "name"),
    "person": partial(fields.text, "person"),
    "task": partial(fields.text, "task"),
    "words": lambda value: fields.words(value) or (),
    "license": partial(fields.text, "license"),
    "source": partial(fields.text, "source"),
    "metadata": metadata,
    "captions": lambda value: fields.captions(value) or (),
}
"""The check of each field of `ClipLabels`. Clients use the same names."""

UNIT = "unit"
HINTS: Mapping[str, Check] = {
    "frame_rate": fields.frame_rate,
    UNIT: fields.metres_per_unit,
    "up_axis": fields.up_axis,
    "roles": fields.roles,
    "stack": partial(fields.text, "stack"),
    "audio_offset": fields.audio_offset,
    "tempo": fields.tempo,
    "beats": fields.beats,
}
"""The check of each hint, by the name that clients use."""

_STORED_NAMES = {UNIT: "metres_per_unit"}
"""The fields of `AnalysisHints` for which clients use another name."""
_CLIENT_NAMES = {stored: name for name, stored in _STORED_NAMES.items()}

RESERVED_KEYS = frozenset(
    {*LABELS, *HINTS, "path", "fps", "keyposes", "audio", "word", "folder", "caption"}
)
"""Names that no key of the metadata has, in upper or lower case: a column of a manifest with such a
name is the field itself."""


def stored_name(name: str) -> str:
    """The name in the store of a label or hint of clients."""
    return _STORED_NAMES.get(name, name)


def client_name(stored: str) -> str:
    """The name that clients use for a stored label or hint."""
    return _CLIENT_NAMES.get(stored, stored)


def checked(values: Mapping[str, Any]) -> ClipChanges:
    """A client's labels and hints in their normal form, by the names of the store.

    values: by the names of LABELS and HINTS; None and empty strings mean that there is no value.
    Raises BadField for a bad value or an unknown name.
    """
    changes: dict[str, Any] = {}
    for field, value in values.items():
        check = LABELS.get(field) or HINTS.get(field)
        if check is None:
            raise bad_field(field, "is no label or hint of a clip")
        changes[stored_name(field)] = check(value)
    return changes


@dataclass(frozen=True, slots=True)
class SentValues:
    """The labels and hints that came with a file; sent: their names, as in `NewClip.sent`."""

    labels: ClipLabels
    hints: AnalysisHints
    sent: frozenset[str]


def sent_values(values: Mapping[str, Any], default_name: str) -> SentValues:
    """The labels and hints that come with a file, checked by `checked`.

    default_name: the clip's name if the values have none. Raises BadField.
    """
    labels = checked({name: value for name, value in values.items() if name not in HINTS})
    hints = checked({name: value for name, value in values.items() if name in HINTS})
    keys: dict[str, MetadataValue | None] = labels.get("metadata") or {}
    names = {*labels, *hints} - {"metadata"} - ({"name"} if not labels.get("name") else set())
    labels = {**labels, "name": labels.get("name") or default_name}
    labels["metadata"] = {key: value for key, value in keys.items() if value is not None}
    return SentValues(
        ClipLabels(**labels),
        AnalysisHints(**hints),
        frozenset(names | {META + key for key in keys}),
    )
