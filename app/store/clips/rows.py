"""Converts a clip's values to columns of the table `clips`, and a row to a record.

Both directions use the fields of the dataclasses in `record`: a new label or hint there is stored
and read without a change here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from sqlalchemy import RowMapping

from app.store.clips.metadata_values import Metadata
from app.store.clips.record import (
    META,
    AnalysisHints,
    AnalysisInput,
    AttachedAudio,
    ClipChanges,
    ClipLabels,
    ClipOrigin,
    ClipRecord,
    ClipState,
    ClipWarning,
    NewClip,
    Reanalysis,
    folder_of,
)
from app.store.database.tables import clips

IN_OTHER_TABLES = ("words", "metadata", "captions")
"""Labels that are not columns of the table `clips`."""
_LABELS = frozenset(field.name for field in fields(ClipLabels))
_HINT_COLUMNS = {field.name: f"{field.name}_override" for field in fields(AnalysisHints)}
_NO_HINTS = AnalysisHints()
_AUDIO_COLUMNS = {field.name: f"audio_{field.name}" for field in fields(AttachedAudio)}
_RECORD_COLUMNS = tuple(field.name for field in fields(ClipRecord) if field.name in clips.c)
_AS_THEY_ARE = _LABELS - set(IN_OTHER_TABLES) | {"imported"}


def client_fields(new: NewClip) -> dict[str, Any]:
    """What is stored of a new clip, by field name as in `ClipChanges`."""
    return {
        **_values(new.labels),
        **_values(new.hints),
        "audio": new.audio,
        "path": new.path,
        "imported": sent_values(new),
    }


def sent_values(new: NewClip) -> dict[str, Any]:
    """The labels and hints that came with a file, by name: see `NewClip.sent`."""
    every = flat(new.labels, new.hints)
    return {name: every.get(name) for name in sorted(new.sent)}


def flat(labels: ClipLabels, hints: AnalysisHints) -> dict[str, Any]:
    """All labels and hints by name, each key of the metadata as `meta.KEY`, in JSON's types.

    An empty list or object is None: there is no value.
    """
    values = {**_values(labels), **_values(hints)}
    metadata: Metadata = values.pop("metadata")
    plain = {name: _plain(value) for name, value in values.items()}
    return plain | {META + key: value for key, value in metadata.items()}


def _plain(value: Any) -> Any:
    return (list(value) if isinstance(value, tuple) else value) or None


def to_columns(changes: ClipChanges) -> dict[str, Any]:
    """Column values for these changes, without those in IN_OTHER_TABLES.

    Raises KeyError for an unknown name.
    """
    columns: dict[str, Any] = {}
    for name, value in changes.items():
        if name == "audio":
            columns |= _audio_columns(value)
        elif name == "path":
            columns |= {"path": value, "folder": folder_of(value)}
        elif name in _AS_THEY_ARE:
            columns[name] = value
        elif name not in IN_OTHER_TABLES:
            columns[_HINT_COLUMNS[name]] = value
    if "name" in columns:
        columns["name_folded"] = columns["name"].casefold()
    return columns


INPUT_COLUMNS = (*_HINT_COLUMNS.values(), _AUDIO_COLUMNS["sha256"])
"""The columns that `input_of` reads."""


def input_of(row: RowMapping) -> AnalysisInput:
    """The input of an analysis of a clip, from its INPUT_COLUMNS."""
    return _hints(row), row[_AUDIO_COLUMNS["sha256"]]


def changed_input(before: ClipRecord, changes: ClipChanges) -> AnalysisInput:
    """The input of an analysis of the clip after the changes."""
    hints = {name: value for name, value in changes.items() if name in _HINT_COLUMNS}
    audio: AttachedAudio | None = changes.get("audio", before.audio)
    return replace(before.hints, **hints), None if audio is None else audio.sha256


def changed_metadata(before: Metadata, changes: ClipChanges) -> Metadata:
    """The metadata of the clip after the changes."""
    if "metadata" not in changes:
        return before
    changed = {**before, **changes["metadata"]} if changes["metadata"] is not None else {}
    return {key: value for key, value in changed.items() if value is not None}


def searched_text(
    name: str, path: str | None, metadata: Metadata, captions: Sequence[str] = ()
) -> str:
    """The text in which a list looks for parts of the name, path, metadata and captions."""
    texts = [name, path or "", *(value for value in metadata.values() if isinstance(value, str))]
    texts += captions
    return "\n".join(texts).casefold()


def to_record(
    row: RowMapping, words: tuple[str, ...], metadata: Metadata, captions: tuple[str, ...]
) -> ClipRecord:
    """A row of `clips`, the clip's words, its metadata and its captions as a record."""
    values: dict[str, Any] = {name: row[name] for name in _RECORD_COLUMNS}
    values |= {
        "words": words,
        "metadata": metadata,
        "captions": captions,
        "imported": row["imported"] or {},
        "state": ClipState(row["state"]),
        "roles": dict(row["roles"] or {}),
        "missing_roles": tuple(row["missing_roles"] or ()),
        "warnings": tuple(ClipWarning(**warning) for warning in row["warnings"] or ()),
        "reanalysis": None if row["reanalysis"] is None else Reanalysis(row["reanalysis"]),
        "hints": _hints(row),
        "origin": origin_of(row),
        "audio": _audio(row),
    }
    return ClipRecord(**values)


def _hints(row: RowMapping) -> AnalysisHints:
    stated = {
        name: _frozen(row[column])
        for name, column in _HINT_COLUMNS.items()
        if row[column] is not None
    }
    return AnalysisHints(**stated) if stated else _NO_HINTS


def _audio(row: RowMapping) -> AttachedAudio | None:
    if row["audio_sha256"] is None:
        return None
    stored = {name: row[column] for name, column in _AUDIO_COLUMNS.items()}
    return AttachedAudio(**{name: value for name, value in stored.items() if value is not None})


def origin_columns(origin: ClipOrigin | None) -> dict[str, Any]:
    """The columns of a new clip's origin."""
    if origin is None:
        return {}
    return {"origin_clip_id": origin.clip_id, "origin_steps": list(origin.steps)}


def origin_of(row: Mapping[str, Any] | RowMapping) -> ClipOrigin | None:
    """The origin of the clip with these columns; None for a clip that is no edited copy."""
    if row["origin_clip_id"] is None:
        return None
    steps = tuple(row["origin_steps"] or ())
    return ClipOrigin(row["origin_clip_id"], steps, is_deleted=row["origin_deleted"])


def _frozen(value: Any) -> Any:
    # JSON has only lists, and a frozen dataclass holds tuples.
    return tuple(value) if isinstance(value, list) else value


def _audio_columns(audio: AttachedAudio | None) -> Mapping[str, Any]:
    return {
        column: None if audio is None else getattr(audio, name)
        for name, column in _AUDIO_COLUMNS.items()
    }


def _values(value: ClipLabels | AnalysisHints) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in fields(value)}
