"""Some fields of clips, for long lists: less than whole clips, and read faster.

To read a thousand whole clips takes about 40 ms, most of it for columns that nobody sees and for
JSON. To read a few plain columns of them takes about 3 ms. Many clips have the same JSON (the same
skeleton), so that each text is parsed once.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from functools import lru_cache
from typing import Any

from sqlalchemy import ColumnElement, Select, Text, cast, select

from app.store.clips import clip_captions, clip_metadata, visibility
from app.store.clips.measures import MEASURES
from app.store.clips.record import ClipState, ClipWarning
from app.store.clips.repository import words_of
from app.store.clips.rows import origin_of
from app.store.database.engine import Tx
from app.store.database.tables import clips
from app.store.database.text_list import as_list, is_one_of

PLAIN = frozenset(
    {
        *("id", "name", "path", "state", "format", "sha256", "person", "task", "license"),
        *("source", "frames", "frame_rate", "declared_frame_rate", "start_offset", "joints"),
        *("created_at", "reanalysis", *MEASURES),
    }
)
"""Fields of `ClipRecord` that are columns of the same name and need no conversion."""

AUDIO = frozenset({"has_audio", "audio_begins_at"})
_AUDIO_COLUMNS = ("audio_sha256", "audio_offset", "audio_offset_override")
ORIGIN = "origin"
_ORIGIN_COLUMNS = ("origin_clip_id", "origin_steps", "origin_deleted")

ShownState = tuple[int, str | None, bool, str | None]
"""What of a ready clip is different whenever one of FIELDS is: the library version of the last
change, and the fields that change without a new version (the state of a new analysis, whether the
original was deleted, the text of the warnings)."""
_STATES = select(
    *(clips.c.id, clips.c.state, clips.c.changed_version, clips.c.reanalysis),
    *(clips.c.origin_deleted, cast(clips.c.warnings, Text)),
).where(is_one_of(clips.c.id, "ids"))

CACHED_TEXTS = 4096
"""Number of different JSON texts that are kept parsed."""


@lru_cache(CACHED_TEXTS)
def _roles(text: str | None) -> dict[str, str]:
    return json.loads(text) if text else {}


@lru_cache(CACHED_TEXTS)
def _missing_roles(text: str | None) -> tuple[str, ...]:
    return tuple(json.loads(text)) if text else ()


@lru_cache(CACHED_TEXTS)
def _warnings(text: str | None) -> tuple[ClipWarning, ...]:
    return tuple(ClipWarning(**warning) for warning in json.loads(text)) if text else ()


def _error(text: str | None) -> dict[str, Any] | None:
    return json.loads(text) if text else None


_PARSERS: Mapping[str, Callable[[str | None], Any]] = {
    "roles": _roles,
    "missing_roles": _missing_roles,
    "warnings": _warnings,
    "error": _error,
}
"""Fields that are columns of JSON, each with the function that reads its text."""

_OF_MANY: Mapping[str, tuple[Callable[[Tx, Collection[str]], Mapping[str, Any]], Any]] = {
    "words": (words_of, ()),
    "metadata": (clip_metadata.get_many, {}),
    "captions": (clip_captions.get_many, ()),
}
"""Fields in tables of their own: the function that reads them by clip id, and the empty value."""

FIELDS = PLAIN | AUDIO | {ORIGIN} | _PARSERS.keys() | _OF_MANY.keys()
"""All fields that `read` knows: attributes of `ClipRecord`."""


class PartialClip:
    """A clip with some of the fields of `ClipRecord`. Other attributes raise AttributeError.

    values: the fields by name. Clips share the values of equal JSON: do not change them. text: the
    clip as JSON, if it was written before; then the values are missing. keep: is given the JSON
    when it is written, if it may be used again.
    """

    __slots__ = ("keep", "text", "values")

    def __init__(self, values: Mapping[str, Any], text: bytes | None = None) -> None:
        self.values = values
        self.text = text
        self.keep: Callable[[bytes], None] | None = None

    def __getattr__(self, name: str) -> Any:
        try:
            return self.values[name]
        except KeyError:
            raise AttributeError(f"{name} was not read") from None


def read(tx: Tx, clip_ids: Collection[str], names: Collection[str]) -> dict[str, PartialClip]:
    """The clips that exist among `clip_ids`, by id, with the fields `names`, all of FIELDS."""
    found: dict[str, dict[str, Any]] = {}
    wanted = frozenset({"id", *names})
    columns, query = _query(wanted)
    parsed = [(name, parse) for name, parse in _PARSERS.items() if name in wanted]
    rows = tx.execute(visibility.of_visible(query), {"ids": as_list(clip_ids)})
    for row in rows.all():
        values = dict(zip(columns, row, strict=True))
        for name, parse in parsed:
            values[name] = parse(values[name])
        found[values["id"]] = values
    if not wanted.isdisjoint(AUDIO):
        for values in found.values():
            _add_audio(values)
    if ORIGIN in wanted:
        for values in found.values():
            values[ORIGIN] = origin_of(values)
    for name, (read_many, empty) in _OF_MANY.items():
        if name in wanted:
            by_id = read_many(tx, found.keys())
            for clip_id, values in found.items():
                values[name] = by_id.get(clip_id, empty)
    return {clip_id: PartialClip(values) for clip_id, values in found.items()}


def shown_states(tx: Tx, clip_ids: Collection[str]) -> dict[str, ShownState]:
    """The states of the ready clips that exist among `clip_ids`, by id."""
    rows = tx.execute(visibility.of_visible(_STATES), {"ids": as_list(clip_ids)})
    ready = ClipState.READY.value
    return {
        clip_id: (version, reanalysis, is_deleted, warnings)
        for clip_id, state, version, reanalysis, is_deleted, warnings in rows.all()
        if state == ready
    }


@lru_cache(64)
def _query(names: frozenset[str]) -> tuple[tuple[str, ...], Select[Any]]:
    """The names of the columns to read, and the query. It is built once for some fields."""
    columns: list[ColumnElement[Any]] = [clips.c[name] for name in sorted(names & PLAIN)]
    # Text and no JSON type, which would parse each value.
    columns += [cast(clips.c[name], Text).label(name) for name in _PARSERS if name in names]
    if not names.isdisjoint(AUDIO):
        columns += [clips.c[name] for name in _AUDIO_COLUMNS]
    if ORIGIN in names:
        columns += [clips.c[name] for name in _ORIGIN_COLUMNS]
    query = select(*columns).where(is_one_of(clips.c.id, "ids"))
    return tuple(query.selected_columns.keys()), query


def _add_audio(values: dict[str, Any]) -> None:
    """Add the fields AUDIO, by the rules of the properties of `ClipRecord`."""
    hint, estimate = values["audio_offset_override"], values["audio_offset"]
    values["has_audio"] = has_audio = values["audio_sha256"] is not None
    values["audio_begins_at"] = (estimate if hint is None else hint) if has_audio else None
